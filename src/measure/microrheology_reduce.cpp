#include "laplace.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/measure/microrheology.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
using Runs = std::span<const MicrorheologyAccumulator>;
constexpr auto channels = MicrorheologyAccumulator::channels, groups = MicrorheologyAccumulator::groups;
constexpr std::size_t fewest_frames = 32, fewest_runs = 4, window_points = 16;

struct Lag {
    std::size_t level, channel;
    std::size_t frames() const { return (channel + 1) << level; }
};

/// Sums of |dx|^2 and what they are over, [lag]; a run, or one group of beads of a run.
struct Block {
    Row sum, weight;
};

void check(Runs runs) {
    if (runs.empty())
        throw InputError("measure: microrheology: no runs");
    for (const MicrorheologyAccumulator& run : runs) {
        if (run.frames() < fewest_frames)
            throw InputError(
                fmt::format("measure: microrheology of {} frames: needs at least {} a run; write frames more "
                            "often or run longer",
                            run.frames(), fewest_frames));
        if (!(run.options() == runs[0].options()) || !(run.layout() == runs[0].layout()))
            throw InputError("measure: microrheology: the runs were measured with different options or beds");
        if (std::abs(run.interval() - runs[0].interval()) > 1e-6 * runs[0].interval())
            throw InputError(
                fmt::format("measure: microrheology: frames are {:g} s apart in one run and {:g} s in "
                            "another: must be the same",
                            runs[0].interval(), run.interval()));
    }
}

double origins(const MicrorheologyAccumulator& run, Lag lag) {
    return lag.level < run.levels().size() ? run.levels()[lag.level].origins[lag.channel] : 0.0;
}

/// Lags that every run has.
std::vector<Lag> common_lags(Runs runs) {
    std::vector<Lag> lags;
    for (std::size_t level = 0; level < runs[0].levels().size(); ++level)
        for (std::size_t c = level == 0 ? 0 : channels / 2; c < channels; ++c)
            if (std::ranges::all_of(runs, [&](const auto& run) { return origins(run, {level, c}) > 0.0; }))
                lags.push_back({level, c});
    return lags;
}

/// The lags that have at least a quarter of the time origins of their run, in every run: beyond, the
/// mean-square displacement is that of hardly more than one stretch of time.
Row well_known(Runs runs, const std::vector<Lag>& lags, const Row& seconds) {
    const auto well = [&](Lag lag) {
        return std::ranges::all_of(runs, [&](const auto& run) {
            const double stride = static_cast<double>(std::size_t{1} << lag.level);
            return 4.0 * stride * origins(run, lag) >= static_cast<double>(run.frames());
        });
    };
    const auto end = std::ranges::find_if_not(lags, well);
    if (end - lags.begin() < 2)
        throw InputError(
            fmt::format("measure: microrheology: only {} lags are known well enough: needs 2; choose a "
                        "longest lag of at least 16 frames",
                        end - lags.begin()));
    return {seconds.begin(), seconds.begin() + (end - lags.begin())};
}

Block block(const MicrorheologyAccumulator& run, const std::vector<Lag>& lags, std::size_t first,
            std::size_t end) {
    Block b{Row(lags.size(), 0.0), Row(lags.size(), 0.0)};
    for (std::size_t i = 0; i < lags.size(); ++i)
        for (std::size_t g = first; g < end; ++g) {
            b.sum[i] += run.levels()[lags[i].level].sum[lags[i].channel * groups + g];
            b.weight[i] += origins(run, lags[i]) * run.group_sizes()[g];
        }
    return b;
}

std::vector<Block> all_blocks(Runs runs, const std::vector<Lag>& lags) {
    std::vector<Block> blocks;
    const std::size_t step = runs.size() >= fewest_runs ? groups : 1;
    for (const MicrorheologyAccumulator& run : runs)
        for (std::size_t g = 0; g < groups; g += step)
            blocks.push_back(block(run, lags, g, g + step));
    return blocks;
}

/// Mean-square displacements of all blocks, or of all but one.
Row pooled(const std::vector<Block>& blocks, std::size_t without) {
    Row sum(blocks[0].sum.size(), 0.0), weight = sum;
    for (std::size_t b = 0; b < blocks.size(); ++b)
        for (std::size_t i = 0; b != without && i < sum.size(); ++i) {
            sum[i] += blocks[b].sum[i];
            weight[i] += blocks[b].weight[i];
        }
    for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] /= weight[i];
    return sum;
}

/// The same curve of all blocks together and with each left out in turn.
struct Jackknife {
    Row all;
    std::vector<Row> without;

    template<class Function>
    static Jackknife of(const std::vector<Block>& blocks, const Function& function) {
        Jackknife curves{function(pooled(blocks, blocks.size())), {}};
        for (std::size_t b = 0; b < blocks.size(); ++b)
            curves.without.push_back(function(pooled(blocks, b)));
        return curves;
    }
    double error(std::size_t i) const {
        const double n = static_cast<double>(without.size());
        double mean = 0.0, scatter = 0.0;
        for (const Row& curve : without)
            mean += curve[i] / n;
        for (const Row& curve : without)
            scatter += (curve[i] - mean) * (curve[i] - mean);
        return std::sqrt(scatter * (n - 1.0) / n);
    }
    Row errors() const {
        Row row;
        for (std::size_t i = 0; i < all.size(); ++i)
            row.push_back(error(i));
        return row;
    }
};

void set_msd(MicrorheologyResult& result, Runs runs, const std::vector<Lag>& lags,
             const std::vector<Block>& blocks) {
    for (const Lag lag : lags) {
        result.lag.push_back(static_cast<double>(lag.frames()) * runs[0].interval());
        result.origins.push_back(0.0);
        for (const MicrorheologyAccumulator& run : runs)
            result.origins.back() += origins(run, lag);
    }
    const Jackknife msd = Jackknife::of(blocks, [](const Row& curve) { return curve; });
    result.msd = msd.all;
    result.msd_error = msd.errors();
}

Row stiffness_curve(const Row& lag, const Row& msd, const Row& s) {
    const auto known = std::span(msd).first(lag.size());
    if (!std::ranges::all_of(known, [](double d) { return d > 0.0; }))
        throw InputError("measure: microrheology: beads that do not move have no stiffness");
    const Sampled function = sampled(lag, known);
    Row stiffness;
    for (const double at : s)
        stiffness.push_back(1.0 / (at * laplace(function, at)));
    return stiffness;
}

Row log_range(double low, double high, std::size_t points) {
    Row range;
    for (std::size_t i = 0; i < points; ++i)
        range.push_back(low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(points - 1)));
    return range;
}

/// Below 1/t_max the transform is mostly the tail's, above half a frame's rate mostly the straight piece from
/// lag 0 to the first lag's.
void set_window(MicrorheologyResult& result, const MicrorheologyOptions& options, double longest,
                double interval) {
    const double low = options.s_low.value_or(2.0 / longest), high = options.s_high.value_or(8.0 / longest);
    result.s_low = std::max(low, 1.0 / longest);
    result.s_high = std::min(high, 0.5 / interval);
    result.window_narrowed = result.s_low != low || result.s_high != high;
    if (result.s_high < 1.5 * result.s_low)
        throw InputError(fmt::format("measure: microrheology: a range of s from {:.4g} to {:.4g} 1/s for s "
                                     "-> 0: from {:.4g} (longest lag) to {:.4g} "
                                     "(frames) can be had and the upper end must be at least 1.5 times the "
                                     "lower; choose another range or longer runs",
                                     low, high, 1.0 / longest, 0.5 / interval));
}

void set_stiffness(MicrorheologyResult& result, const std::vector<Block>& blocks, const Row& lag,
                   double interval) {
    const double octaves = std::log2(2.0 * lag.back() / interval);
    result.s =
        log_range(0.5 / lag.back(), 1.0 / interval, 1 + static_cast<std::size_t>(std::ceil(4.0 * octaves)));
    const Jackknife curves =
        Jackknife::of(blocks, [&](const Row& msd) { return stiffness_curve(lag, msd, result.s); });
    result.stiffness = curves.all;
    result.stiffness_error = curves.errors();
}

/// Value at s = 0 of the straight line through the first points of a curve.
double at_zero(const Row& s, const Row& stiffness, const Row& errors, std::size_t points) {
    const auto first = [&](const Row& row) { return std::span(row).first(points); };
    return fit_line(first(s), first(stiffness), first(errors)).intercept.value;
}

/// {extrapolated value, how far the bend of the curve puts it off}. A part c s^2 of the curve puts the line
/// through s_1 and s_2 off by -c s_1 s_2 at 0, so the line through the lower half of the points is off by
/// less.
Row extrapolated(const Row& s, const Row& stiffness, const Row& errors) {
    const std::size_t lower = s.size() / 2;
    const double whole = at_zero(s, stiffness, errors, s.size());
    const double half = at_zero(s, stiffness, errors, lower);
    return {whole, (whole - half) / (1.0 - s[lower - 1] / s.back())};
}

void set_stiffness_zero(MicrorheologyResult& result, const std::vector<Block>& blocks, const Row& lag) {
    const Row s = log_range(result.s_low, result.s_high, window_points);
    const Jackknife curves =
        Jackknife::of(blocks, [&](const Row& msd) { return stiffness_curve(lag, msd, s); });
    Row errors = curves.errors();
    for (std::size_t i = 0; i < s.size(); ++i) // blocks that agree to round-off still weigh the points
        errors[i] = std::max(errors[i], 1e-12 * curves.all[i]);
    Jackknife zero{extrapolated(s, curves.all, errors), {}};
    for (const Row& curve : curves.without)
        zero.without.push_back(extrapolated(s, curve, errors));
    const double bend = zero.all[1], noise = zero.error(1);
    result.bend = std::sqrt(std::max(0.0, bend * bend - noise * noise));
    result.scatter = zero.error(0);
    result.stiffness_zero = {zero.all[0], std::hypot(result.scatter, result.bend), blocks.size()};
}

void set_spring(MicrorheologyResult& result, Runs runs) {
    double sum = 0.0;
    for (const MicrorheologyAccumulator& run : runs) {
        sum += run.temperature() * static_cast<double>(run.frames());
        result.frames += run.frames();
    }
    result.temperature = sum / static_cast<double>(result.frames);
    const double factor = 4.0 * runs[0].layout().bead_mass * result.temperature;
    result.spring = result.stiffness_zero.scaled(factor);
}

} // namespace

void MicrorheologyResult::use_temperature(double T) {
    spring = spring.scaled(T / temperature);
    temperature = T;
}

MicrorheologyResult reduce(Runs runs) {
    check(runs);
    const std::vector<Lag> lags = common_lags(runs);
    const std::vector<Block> blocks = all_blocks(runs, lags);
    MicrorheologyResult result;
    set_msd(result, runs, lags, blocks);
    const Row lag = well_known(runs, lags, result.lag);
    set_window(result, runs[0].options(), lag.back(), runs[0].interval());
    set_stiffness(result, blocks, lag, runs[0].interval());
    set_stiffness_zero(result, blocks, lag);
    set_spring(result, runs);
    return result;
}

} // namespace rodwake::measure
