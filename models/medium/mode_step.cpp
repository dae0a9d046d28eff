#include "mode_step.hpp"

#include "rods/interaction.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::medium {

ModeStep::ModeStep(const elastic::Medium& elastic, const DynamicMedium& medium,
                   const rods::Couplings& couplings, std::size_t rods, std::size_t threads,
                   const rods::BodyForces& bodies)
    : CoupledStep(bodies), modes_(elastic, medium), couplings_(couplings), rods_(rods),
      steady_(medium.start == Start::steady), team_(threads),
      fields_(modes_, couplings, medium.self_field, rods, modes_.numbers(), team_) {
    validate(elastic, medium, rods);
    if (evaluation_of(medium, rods) == Evaluation::mesh) {
        mesh_.emplace(modes_, medium.box, team_);
        if (!medium.self_field)
            own_.emplace(elastic, medium, couplings, modes_);
    }
    for (Forces& forces : forces_)
        forces.resize(count() * 4 * modes_.size());
    for (std::size_t k = 0; k < 4; ++k) {
        poses_[k].resize(3 * rods);
        slopes_[k].resize(3 * rods);
    }
    turning_.resize(rods);
    if (modes_.inertia > 0.0)
        wave_.resize(2 * modes_.size());
    else
        decay_.resize(2 * modes_.size());
}

Coupled ModeStep::start(std::vector<double> poses) {
    const std::size_t amplitudes = count() * modes_.numbers();
    Coupled state{std::move(poses),
                  std::vector<double>(amplitudes + (own_ ? OwnResponse::numbers(rods_) : 0))};
    if (steady_)
        add_steady(state.poses, state.fields);
    if (own_)
        own_->start(state.poses, std::span(state.fields).subspan(amplitudes));
    return state;
}

/// Rods in blocks, whose phases fit into memory; rows of modes by the threads.
void ModeStep::add_steady(std::span<const double> poses, std::span<double> fields) {
    if (mesh_ && modes_.inertia == 0.0)
        return mesh_->add_steady(poses, fields);
    constexpr std::size_t block = 128;
    std::vector<PhaseFactors> px(block), py(block);
    for (std::size_t first = 0; first < rods_; first += block) {
        const std::size_t count = std::min(block, rods_ - first);
        team_.run(count, [&](std::size_t k) {
            px[k] = phases(modes_.qx, -poses[3 * (first + k)]);
            py[k] = phases(modes_.qy, -poses[3 * (first + k) + 1]);
        });
        team_.run(modes_.rows(), [&](std::size_t row) {
            for (std::size_t k = 0; k < count; ++k) {
                const rods::Pose rod = rods::pose(poses, first + k);
                if (mesh_ || fields_.common())
                    modes_.add_steady_row(row, 0, modes_.columns(), rod, px[k], py[k], fields);
                if (!mesh_ && fields_.own())
                    modes_.add_steady_row(row, 0, modes_.columns(), rod, px[k], py[k],
                                          fields.subspan(fields_.at(first + k)));
            }
        });
    }
}

void ModeStep::free_rates(integrate::State poses, std::span<const double> fields, std::span<double> ydot) {
    if (!mesh_)
        return fields_.rates(poses, fields, ydot);
    const bool acting = !own_ || rods_ > 1;
    if (acting)
        mesh_->turning(poses, fields, couplings_, turning_);
    const std::span<const double> own = fields.subspan(modes_.numbers());
    for (std::size_t a = 0; a < rods_; ++a) {
        const rods::Direction n = rods::direction(poses, a);
        ydot[3 * a] = n.cosine;
        ydot[3 * a + 1] = n.sine;
        ydot[3 * a + 2] = acting ? turning_[a] - (own_ ? own_->turning(poses, a, own) : 0.0) : 0.0;
    }
}

std::vector<double> ModeStep::own_turning(const Coupled& state) {
    return mesh_ ? std::vector<double>{} : fields_.own_turning(state.poses, state.fields);
}

void ModeStep::prepare(double h) {
    if (h == h_)
        return;
    h_ = h;
    const std::size_t columns = modes_.columns(), size = modes_.size();
    team_.run(2 * modes_.rows(), [&](std::size_t row) {
        for (std::size_t k = row * columns; k < (row + 1) * columns; ++k) {
            const double decay = k < size ? modes_.decay_longitudinal[k] : modes_.decay_transverse[k - size];
            if (modes_.force[k < size ? k : k - size] == 0.0)
                continue; // does not count, and stays 0
            if (modes_.inertia > 0.0)
                wave_[k] = wave_weights(decay, modes_.inertia, h);
            else
                decay_[k] = decay_weights(decay, h);
        }
    });
}

void ModeStep::find_forces(integrate::State poses, Forces& forces) {
    if (mesh_)
        return mesh_->forces(poses, forces);
    std::ranges::fill(forces, 0.0);
    const std::size_t columns = modes_.columns(), size = modes_.size();
    for (std::size_t rod = 0; rod < rods_; ++rod) {
        const rods::Direction n = rods::direction(poses, rod);
        const PhaseFactors px = phases(modes_.qx, -poses[3 * rod]),
                           py = phases(modes_.qy, -poses[3 * rod + 1]);
        const std::size_t own = fields_.at(rod) / modes_.numbers() * 4 * size;
        team_.run(modes_.rows(), [&](std::size_t row) {
            for (std::size_t column = 0, i = row * columns; column < columns; ++column, ++i) {
                const double f = modes_.force[i], ux = modes_.unit_x[i], uy = modes_.unit_y[i];
                const double l = f * (n.cosine * ux + n.sine * uy), t = f * (n.sine * ux - n.cosine * uy);
                const Complex phase = Complex{px.re[row], px.im[row]} * Complex{py.re[column], py.im[column]};
                const std::array<double, 4> force{l * phase.re, l * phase.im, t * phase.re, t * phase.im};
                for (std::size_t block = 0; block < 4; ++block) {
                    if (fields_.common())
                        forces[block * size + i] += force[block];
                    if (fields_.own())
                        forces[own + block * size + i] += force[block];
                }
            }
        });
    }
}

void ModeStep::advance_row(std::size_t row, std::size_t stage, std::size_t field,
                           std::span<const double> from, std::span<double> to) const {
    const std::size_t columns = modes_.columns(), size = modes_.size(), first = field * 4 * size;
    for (std::size_t block = 0; block < 4; ++block) // l_re, l_im, t_re, t_im
        for (std::size_t i = row * columns; i < (row + 1) * columns; ++i) {
            std::array<double, 4> f{};
            for (std::size_t j = 0; j < stage; ++j)
                f[j] = forces_[j][first + block * size + i];
            const std::size_t at = block * size + i, mode = block / 2 * size + i;
            if (wave_.empty()) {
                const DecayWeights& w = decay_[mode];
                to[at] = (stage < 3 ? w.half : w.full) * from[at] + weighted(stage, w.force, f);
                continue;
            }
            const WaveWeights& w = wave_[mode];
            const WaveWeights::Propagator& p = stage < 3 ? w.half : w.full;
            const double u = from[at], v = from[at + 4 * size];
            to[at] = p.uu * u + p.uv * v + weighted(stage, w.u, f);
            to[at + 4 * size] = p.vu * u + p.vv * v + weighted(stage, w.v, f);
        }
}

/// The fields at stage 1, 2, 3 or the end, 4.
void ModeStep::fields_at(std::size_t stage, double h, std::span<const double> from, std::span<double> to) {
    const std::size_t numbers = modes_.numbers(), amplitudes = count() * numbers;
    team_.run(modes_.rows(), [&](std::size_t row) {
        for (std::size_t k = 0; k < count(); ++k)
            advance_row(row, stage, k, from.subspan(k * numbers, numbers), to.subspan(k * numbers, numbers));
    });
    if (own_)
        own_->advance(stage, h, {poses_[0], poses_[1], poses_[2], poses_[3]}, from.subspan(amplitudes),
                      to.subspan(amplitudes));
}

void ModeStep::take(const Coupled& before, std::span<const double> rates_before, double h, Coupled& after) {
    after.poses.resize(before.poses.size());
    after.fields.resize(before.fields.size());
    stage_fields_.resize(before.fields.size());
    prepare(h);
    poses_[0] = before.poses;
    std::ranges::copy(rates_before, slopes_[0].begin());
    find_forces(poses_[0], forces_[0]);
    constexpr std::array<double, 3> when{0.5, 0.5, 1.0};
    for (std::size_t stage = 1; stage < 4; ++stage) {
        for (std::size_t i = 0; i < before.poses.size(); ++i)
            poses_[stage][i] = before.poses[i] + when[stage - 1] * h * slopes_[stage - 1][i];
        fields_at(stage, h, before.fields, stage_fields_);
        rates(poses_[stage], stage_fields_, slopes_[stage]);
        find_forces(poses_[stage], forces_[stage]);
    }
    for (std::size_t i = 0; i < after.poses.size(); ++i)
        after.poses[i] = before.poses[i] +
                         h / 6.0 * (slopes_[0][i] + 2.0 * (slopes_[1][i] + slopes_[2][i]) + slopes_[3][i]);
    fields_at(4, h, before.fields, after.fields);
}

} // namespace rodwake::medium
