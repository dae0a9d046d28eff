#include "exponential_step.hpp"

#include "rods/interaction.hpp" // rods::direction

#include <algorithm>
#include <cmath>

namespace rodwake::medium {

ExponentialStep::ExponentialStep(const elastic::Medium& elastic, const DynamicMedium& medium,
                                 const rods::Couplings& couplings, std::size_t rods, std::size_t threads,
                                 const rods::BodyForces& bodies)
    : CoupledStep(bodies), modes_(elastic, medium), rods_(rods), steady_(medium.start == Start::steady),
      team_(threads), fields_(modes_, couplings, medium.self_field, rods, 4 * modes_.size(), team_) {
    validate(elastic, medium, rods);
    const std::size_t numbers = 4 * modes_.size();
    decay_.resize(numbers);
    weights_.resize(2 * modes_.size() * rods);
    paths_.resize(rods);
    stage_ = {std::vector<double>(3 * rods), std::vector<double>(numbers * fields_.count())};
    for (std::vector<double>& slope : slopes_)
        slope.resize(3 * rods);
}

Coupled ExponentialStep::start(std::vector<double> poses) {
    const std::size_t numbers = 4 * modes_.size();
    Coupled state{std::move(poses), std::vector<double>(numbers * fields_.count())};
    for (std::size_t rod = 0; steady_ && rod < rods_; ++rod) {
        const rods::Pose pose = rods::pose(state.poses, rod);
        if (fields_.common())
            modes_.add_steady(pose, std::span(state.fields).first(numbers));
        if (fields_.own())
            modes_.add_steady(pose, std::span(state.fields).subspan(fields_.at(rod), numbers));
    }
    return state;
}

void ExponentialStep::prepare(const Coupled& before, double h) {
    const std::size_t columns = modes_.columns(), size = modes_.size();
    for (std::size_t rod = 0; rod < rods_; ++rod) {
        paths_[rod].stages.clear();
        add_stage(rod, before.poses, before.poses, 0.0);
        paths_[rod].y = phases(modes_.qy, 0.5 * h * paths_[rod].stages.front().ny);
    }
    team_.run(modes_.rows(), [&](std::size_t row) {
        for (std::size_t i = row * columns; i < (row + 1) * columns; ++i)
            for (std::size_t part = 0; part < 2; ++part) {
                const double rate = part == 0 ? modes_.decay_longitudinal[i] : modes_.decay_transverse[i];
                decay_[part * size + i] = std::exp(-0.5 * h * rate);
                decay_[(2 + part) * size + i] = std::exp(-h * rate);
            }
        for (std::size_t rod = 0; rod < rods_; ++rod) {
            const RodPath& path = paths_[rod];
            const RodStage& first = path.stages.front();
            const double turn_x = 0.5 * h * modes_.qx[row] * first.nx;
            const Complex phase_x{std::cos(turn_x), std::sin(turn_x)};
            for (std::size_t column = 0, i = row * columns; column < columns; ++column, ++i) {
                if (modes_.force[i] == 0.0)
                    continue;
                const double turn_y = 0.5 * h * modes_.qy[column] * first.ny;
                // of the row's columns alone; a table of them would be read from memory
                const Complex phase = phase_x * Complex{path.y.re[column], path.y.im[column]};
                for (std::size_t part = 0; part < 2; ++part) {
                    const double rate = part == 0 ? modes_.decay_longitudinal[i] : modes_.decay_transverse[i];
                    const Phi half = phi({-0.5 * h * rate, turn_x + turn_y}, decay_[part * size + i] * phase);
                    const Phi full = doubled(half);
                    const double scale = h * modes_.force[i];
                    weights_[(2 * rod + part) * size + i] = {0.5 * scale * half.one, scale * half.two,
                                                             scale * full.one, scale * full.two,
                                                             scale * full.three};
                }
            }
        }
    });
}

/// Of a stage at `time` after the start: the velocity there, and how far off its frame the rod is.
void ExponentialStep::add_stage(std::size_t rod, integrate::State before, integrate::State poses,
                                double time) {
    const rods::Direction n = rods::direction(poses, rod), v = rods::direction(before, rod);
    const double dx = poses[3 * rod] - before[3 * rod] - v.cosine * time;
    const double dy = poses[3 * rod + 1] - before[3 * rod + 1] - v.sine * time;
    paths_[rod].stages.push_back({n.cosine, n.sine, phases(modes_.qx, -dx), phases(modes_.qy, -dy)});
}

/// Adds what a rod's force did to one row of its field up to stage 1, 2, 3 or the end, 4.
void ExponentialStep::advance_row(std::size_t row, std::size_t stage, std::size_t rod,
                                  std::span<double> field) const {
    const std::size_t columns = modes_.columns(), size = modes_.size();
    const RodPath& path = paths_[rod];
    const Complex frame_x{path.x.re[row], path.x.im[row]};
    for (std::size_t column = 0; column < columns; ++column) {
        const std::size_t i = row * columns + column;
        if (modes_.force[i] == 0.0)
            continue;
        std::array<Complex, 4> off; // phases of the stages so far
        for (std::size_t j = 0; j < stage; ++j) {
            const RodStage& s = path.stages[j];
            off[j] = Complex{s.x.re[row], s.x.im[row]} * Complex{s.y.re[column], s.y.im[column]};
        }
        const Complex frame = frame_x * Complex{path.y.re[column], path.y.im[column]};
        for (std::size_t part = 0; part < 2; ++part) {
            std::array<Complex, 4> f; // forces along q, or across
            for (std::size_t j = 0; j < stage; ++j) {
                const RodStage& s = path.stages[j];
                const double ux = modes_.unit_x[i], uy = modes_.unit_y[i];
                f[j] = (part == 0 ? s.nx * ux + s.ny * uy : s.ny * ux - s.nx * uy) * off[j];
            }
            const StageWeights& w = weights_[(2 * rod + part) * size + i];
            Complex sum;
            if (stage == 1)
                sum = w.half_one * f[0];
            else if (stage == 2)
                sum = (w.half_one - w.half_two) * f[0] + w.half_two * f[1];
            else if (stage == 3)
                sum = (w.one - 2.0 * w.two) * f[0] + 2.0 * w.two * f[2];
            else
                sum = (w.one - 3.0 * w.two + 4.0 * w.three) * f[0] +
                      (2.0 * w.two - 4.0 * w.three) * (f[1] + f[2]) + (4.0 * w.three - w.two) * f[3];
            sum = frame * sum;
            field[2 * part * size + i] += sum.re;
            field[(2 * part + 1) * size + i] += sum.im;
        }
    }
}

/// The fields at stage 1, 2, 3 or the end, 4, which is `time` after the start.
void ExponentialStep::fields_at(std::size_t stage, integrate::State before, std::span<const double> from,
                                double time, std::span<double> to) {
    const std::size_t numbers = 4 * modes_.size();
    for (std::size_t rod = 0; rod < rods_; ++rod) {
        const rods::Direction v = rods::direction(before, rod);
        paths_[rod].x = phases(modes_.qx, -(before[3 * rod] + v.cosine * time));
        paths_[rod].y = phases(modes_.qy, -(before[3 * rod + 1] + v.sine * time));
    }
    team_.run(modes_.rows(), [&](std::size_t row) {
        const std::size_t columns = modes_.columns(), size = modes_.size();
        for (std::size_t block = 0; block < 4 * fields_.count();
             ++block) { // of each field l_re, l_im, t_re, t_im
            const double* e = &decay_[((stage < 3 ? 0 : 2) + block % 4 / 2) * size];
            for (std::size_t i = row * columns; i < (row + 1) * columns; ++i)
                to[block * size + i] = e[i] * from[block * size + i];
        }
        for (std::size_t rod = 0; rod < rods_; ++rod) {
            if (fields_.common())
                advance_row(row, stage, rod, to.first(numbers));
            if (fields_.own())
                advance_row(row, stage, rod, to.subspan(fields_.at(rod), numbers));
        }
    });
}

void ExponentialStep::take(const Coupled& before, std::span<const double> rates_before, double h,
                           Coupled& after) {
    after.poses.resize(before.poses.size());
    after.fields.resize(before.fields.size());
    prepare(before, h);
    std::ranges::copy(rates_before, slopes_[0].begin());
    constexpr std::array<double, 3> when{0.5, 0.5, 1.0};
    for (std::size_t stage = 1; stage < 4; ++stage) {
        const double time = when[stage - 1] * h;
        for (std::size_t i = 0; i < stage_.poses.size(); ++i)
            stage_.poses[i] = before.poses[i] + time * slopes_[stage - 1][i];
        fields_at(stage, before.poses, before.fields, time, stage_.fields);
        rates(stage_.poses, stage_.fields, slopes_[stage]);
        for (std::size_t rod = 0; rod < rods_; ++rod)
            add_stage(rod, before.poses, stage_.poses, time);
    }
    for (std::size_t i = 0; i < after.poses.size(); ++i)
        after.poses[i] = before.poses[i] +
                         h / 6.0 * (slopes_[0][i] + 2.0 * (slopes_[1][i] + slopes_[2][i]) + slopes_[3][i]);
    fields_at(4, before.poses, before.fields, h, after.fields);
}

} // namespace rodwake::medium
