#include "phonon_sums.hpp"
#include "plane_waves.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/phonons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
using Mode = PhononAccumulator::Mode;
constexpr std::size_t most_shells = 16;
constexpr std::size_t displacement_stride = 4; // u changes slowly against the interval of the currents

Row without_mean(Row values) {
    const double m = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    for (double& v : values)
        v -= m;
    return values;
}

double sum_of_squares(const Row& values) {
    return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

/// exp(-i k theta) for k = 0, 1, ...
void powers(double theta, std::span<std::complex<double>> out) {
    const std::complex<double> first = turn_by(-theta);
    out[0] = 1.0;
    for (std::size_t k = 1; k < out.size(); ++k)
        out[k] = times(out[k - 1], first);
}

/// sum_i (u_i, w_i) exp(-i q.r_i) along and across q: [L re, L im, T re, T im][mode].
Row fourier(const Layout& layout, std::span<const Mode> modes, std::size_t shells, const Row& x, const Row& y,
            const Row& u, const Row& w) {
    const std::size_t count = modes.size();
    const double per_x = 2.0 * std::numbers::pi / layout.box.x, per_y = 2.0 * std::numbers::pi / layout.box.y;
    std::vector<std::complex<double>> along_x(shells + 1), along_y(shells + 1);
    Row sums(4 * count, 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
        powers(per_x * x[i], along_x);
        powers(per_y * y[i], along_y);
        for (std::size_t k = 0; k < count; ++k) {
            const auto& factor = along_y[static_cast<std::size_t>(std::abs(modes[k].n))];
            const auto wave = times(along_x[static_cast<std::size_t>(modes[k].m)],
                                    modes[k].n < 0 ? std::conj(factor) : factor);
            sums[k] += u[i] * wave.real();
            sums[count + k] += u[i] * wave.imag();
            sums[2 * count + k] += w[i] * wave.real();
            sums[3 * count + k] += w[i] * wave.imag();
        }
    }
    for (std::size_t k = 0; k < count; ++k) { // to the axes along and across q
        const double qx = per_x * modes[k].m, qy = per_y * modes[k].n, q = std::hypot(qx, qy);
        for (const std::size_t part : {std::size_t{0}, count}) {
            const Vector2 turned = seen_along({sums[part + k], sums[part + 2 * count + k]}, qx / q, qy / q);
            sums[part + k] = turned.x;
            sums[part + 2 * count + k] = turned.y;
        }
    }
    return sums;
}

} // namespace

PhononAccumulator::PhononAccumulator(const Layout& layout, const PhononOptions& options)
    : layout_(layout), options_(options) {
    validate(layout);
    if (options.shells < 1 || options.shells > most_shells)
        throw InputError(fmt::format("measure: phonons: {} waves along a side: must be from 1 to {}",
                                     options.shells, most_shells));
    if (!(std::isfinite(options.longest_lag) && options.longest_lag > 0.0))
        throw InputError(fmt::format("measure: phonons, longest lag {:g} s: must be finite and positive",
                                     options.longest_lag));
    if (!(options.block >= 2.0 * options.longest_lag))
        throw InputError(fmt::format("measure: phonons: blocks of {:g} s are shorter than twice the longest "
                                     "lag of {:g} s; choose a longer measure.block",
                                     options.block, options.longest_lag));
    const int most = static_cast<int>(options.shells);
    for (int m = 0; m <= most; ++m)
        for (int n = m == 0 ? 1 : -most; n <= most; ++n)
            if (m * m + n * n <= most * most)
                modes_.push_back({m, n});
}

void PhononAccumulator::add(const Frame& frame) {
    check_frame(layout_, frame);
    times_.next(frame.time, "phonons");
    if (times_.frames == 1) {
        first_time_ = frame.time;
        first_x_ = frame.unwrapped_x;
        first_y_ = frame.unwrapped_y;
    }
    const Row vx = without_mean(frame.vx), vy = without_mean(frame.vy);
    const double beads = static_cast<double>(layout_.beads);
    const double temperature = (sum_of_squares(vx) + sum_of_squares(vy)) / (2.0 * beads);
    const Row currents = fourier(layout_, modes_, options_.shells, without_mean(frame.unwrapped_x),
                                 without_mean(frame.unwrapped_y), vx, vy);
    if (times_.frames == 2) { // the interval, and so the number of lags, is known
        lags_ = 1 + static_cast<std::size_t>(options_.longest_lag / times_.interval * (1.0 + 1e-9));
        correlate(block_at(first_time_), first_temperature_);
    }
    history_.push_back(currents);
    if (times_.frames == 1) {
        first_temperature_ = temperature;
        return;
    }
    if (history_.size() > lags_)
        history_.pop_front();
    correlate(block_at(frame.time), temperature);
    if (times_.frames % displacement_stride == 0)
        take_displacements(frame);
}

PhononAccumulator::PhononBlock& PhononAccumulator::block_at(double time) {
    const double number = std::floor((time - first_time_) / options_.block * (1.0 + 1e-9));
    if (blocks_.empty() || blocks_.back().number != number) {
        PhononBlock block;
        block.number = number;
        block.origins.assign(lags_, 0.0);
        block.currents.assign(lags_ * 3 * modes_.size(), 0.0);
        block.amplitude.assign(6 * modes_.size(), 0.0);
        blocks_.push_back(std::move(block));
    }
    return blocks_.back();
}

/// The newest frame with those before it.
void PhononAccumulator::correlate(PhononBlock& block, double temperature) const {
    const std::size_t count = modes_.size();
    const double* now = history_.back().data();
    block.frames += 1.0;
    block.temperature += temperature;
    for (std::size_t lag = 0; lag < history_.size(); ++lag) {
        const double* past = history_[history_.size() - 1 - lag].data();
        double* sums = block.currents.data() + 3 * count * lag;
        for (std::size_t k = 0; k < count; ++k) {
            const double Lr = now[k], Li = now[count + k], Tr = now[2 * count + k], Ti = now[3 * count + k];
            const double lr = past[k], li = past[count + k], tr = past[2 * count + k],
                         ti = past[3 * count + k];
            sums[k] += Lr * lr + Li * li;
            sums[count + k] += Tr * tr + Ti * ti;
            sums[2 * count + k] += 0.5 * (Lr * tr + Li * ti + Tr * lr + Ti * li);
        }
        block.origins[lag] += 1.0;
    }
}

void PhononAccumulator::take_displacements(const Frame& frame) {
    const std::size_t count = modes_.size();
    Row dx(layout_.beads), dy(layout_.beads);
    for (std::size_t i = 0; i < layout_.beads; ++i) {
        dx[i] = frame.unwrapped_x[i] - first_x_[i];
        dy[i] = frame.unwrapped_y[i] - first_y_[i];
    }
    dx = without_mean(std::move(dx));
    dy = without_mean(std::move(dy));
    const Row u = fourier(layout_, modes_, options_.shells, first_x_, first_y_, dx, dy);
    PhononBlock& block = blocks_.back();
    block.displacements += 1.0;
    block.travel += (sum_of_squares(dx) + sum_of_squares(dy)) / static_cast<double>(layout_.beads);
    for (std::size_t i = 0; i < u.size(); ++i)
        block.amplitude[i] += u[i];
    for (std::size_t k = 0; k < count; ++k) {
        block.amplitude[4 * count + k] += u[k] * u[k] + u[count + k] * u[count + k];
        block.amplitude[5 * count + k] +=
            u[2 * count + k] * u[2 * count + k] + u[3 * count + k] * u[3 * count + k];
    }
}

void PhononAccumulator::save(StateWriter& out) const {
    times_.save(out);
    out.put(first_time_);
    out.put(first_temperature_);
    out.put(lags_);
    out.put(first_x_);
    out.put(first_y_);
    out.put(history_.size());
    for (const Row& currents : history_)
        out.put(currents);
    out.put(blocks_.size());
    for (const PhononBlock& block : blocks_) {
        for (const double value :
             {block.number, block.frames, block.temperature, block.displacements, block.travel})
            out.put(value);
        out.put(block.origins);
        out.put(block.currents);
        out.put(block.amplitude);
    }
}

void PhononAccumulator::load(StateReader& in) {
    times_.load(in);
    first_time_ = in.get();
    first_temperature_ = in.get();
    lags_ = in.count();
    const std::size_t beads = times_.frames > 0 ? layout_.beads : 0, count = modes_.size();
    first_x_ = in.array(beads);
    first_y_ = in.array(beads);
    history_.clear();
    for (std::size_t left = in.count(); left > 0; --left)
        history_.push_back(in.array(4 * count));
    blocks_.clear();
    for (std::size_t left = in.count(); left > 0; --left) {
        PhononBlock block;
        for (double* value :
             {&block.number, &block.frames, &block.temperature, &block.displacements, &block.travel})
            *value = in.get();
        block.origins = in.array(lags_);
        block.currents = in.array(3 * count * lags_);
        block.amplitude = in.array(6 * count);
        blocks_.push_back(std::move(block));
    }
}

namespace {

using Runs = std::span<const PhononAccumulator>;
using PhononBlock = PhononAccumulator::PhononBlock;
constexpr std::size_t most_blocks = 64;

void add(PhononSums& sum, const PhononSums& other) {
    const auto plus = [](Row& a, const Row& b) {
        for (std::size_t i = 0; i < a.size(); ++i)
            a[i] += b[i];
    };
    sum.block.frames += other.block.frames;
    sum.block.temperature += other.block.temperature;
    plus(sum.block.origins, other.block.origins);
    plus(sum.block.currents, other.block.currents);
    plus(sum.squares, other.squares);
    sum.displacements += other.displacements;
}

} // namespace

std::vector<PhononSums> phonon_blocks(Runs runs) {
    std::vector<PhononSums> blocks;
    for (const PhononAccumulator& run : runs)
        for (std::size_t b = 0; b < run.blocks().size(); ++b) {
            const PhononBlock& block = run.blocks()[b];
            const std::size_t modes = run.modes().size();
            PhononSums sums{block, Row(2 * modes, 0.0), block.displacements};

            // Variance of u over a block's time, summed over its frames; it is taken block by block, so that
            // what creeps over longer times does not count.
            for (std::size_t part = 0; part < 2 && block.displacements > 0.0; ++part)
                for (std::size_t k = 0; k < modes; ++k) {
                    const double re = block.amplitude[2 * part * modes + k],
                                 im = block.amplitude[(2 * part + 1) * modes + k];
                    sums.squares[part * modes + k] =
                        block.amplitude[(4 + part) * modes + k] - (re * re + im * im) / block.displacements;
                }
            if (b > 0 && 2.0 * sums.block.frames < run.blocks()[0].frames)
                add(blocks.back(), sums);
            else
                blocks.push_back(sums);
        }
    const std::size_t together = (blocks.size() + most_blocks - 1) / most_blocks;
    std::vector<PhononSums> groups;
    for (std::size_t b = 0; b < blocks.size(); ++b)
        if (b % together == 0)
            groups.push_back(blocks[b]);
        else
            add(groups.back(), blocks[b]);
    return groups;
}

PhononSums pooled(const std::vector<PhononSums>& blocks, std::size_t without) {
    const std::size_t first = without == 0 ? 1 : 0;
    PhononSums sum = blocks[first];
    for (std::size_t b = first + 1; b < blocks.size(); ++b)
        if (b != without)
            add(sum, blocks[b]);
    return sum;
}

std::vector<MirrorModes> mirror_modes(std::span<const PhononAccumulator::Mode> modes) {
    std::vector<MirrorModes> classes;
    for (std::size_t k = 0; k < modes.size(); ++k) {
        const int n = std::abs(modes[k].n);
        auto found = std::ranges::find_if(
            classes, [&](const MirrorModes& c) { return c.m == modes[k].m && c.n == n; });
        if (found == classes.end())
            found = classes.insert(classes.end(), {modes[k].m, n, {}});
        found->members.emplace_back(k, modes[k].n < 0 ? -1.0 : 1.0);
    }
    std::ranges::stable_sort(classes, {}, [](const MirrorModes& c) { return c.m * c.m + c.n * c.n; });
    return classes;
}

CurrentCorrelations correlations_of(const PhononSums& sums, const MirrorModes& mirrored, std::size_t modes,
                                    double beads) {
    const std::size_t lags = sums.block.origins.size();
    CurrentCorrelations c{Row(lags, 0.0), Row(lags, 0.0), Row(lags, 0.0)};
    for (std::size_t lag = 0; lag < lags; ++lag) {
        const double each =
            1.0 / (beads * sums.block.origins[lag] * static_cast<double>(mirrored.members.size()));
        const double* at = sums.block.currents.data() + 3 * modes * lag;
        for (const auto& [k, sign] : mirrored.members) {
            c.LL[lag] += each * at[k];
            c.TT[lag] += each * at[modes + k];
            c.LT[lag] += each * sign * at[2 * modes + k];
        }
    }
    return c;
}

double polarisation_of(const CurrentCorrelations& c) {
    double dd = 0.0, dx = 0.0, xx = 0.0;
    for (std::size_t lag = 1; lag < c.LL.size(); ++lag) {
        const double d = 0.5 * (c.LL[lag] - c.TT[lag]), x = c.LT[lag];
        dd += d * d;
        dx += d * x;
        xx += x * x;
    }
    return 0.25 * std::atan2(2.0 * dx, dd - xx);
}

CurrentCorrelations turned(const CurrentCorrelations& c, double angle) {
    const double cs = std::cos(angle), sn = std::sin(angle);
    CurrentCorrelations t = c;
    for (std::size_t lag = 0; lag < c.LL.size(); ++lag) {
        t.LL[lag] = cs * cs * c.LL[lag] + 2.0 * cs * sn * c.LT[lag] + sn * sn * c.TT[lag];
        t.TT[lag] = sn * sn * c.LL[lag] - 2.0 * cs * sn * c.LT[lag] + cs * cs * c.TT[lag];
    }
    return t;
}

} // namespace rodwake::measure
