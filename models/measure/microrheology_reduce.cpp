#include "lag_blocks.hpp"
#include "laplace.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/microrheology.hpp"
#include "stiffness_spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
using Runs = MicrorheologyRuns;
constexpr std::size_t fewest_frames = 32, window_points = 16;

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

void set_msd(MicrorheologyResult& result, Runs runs, const std::vector<Lag>& lags,
             const std::vector<LagBlock>& blocks) {
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

void set_stiffness(MicrorheologyResult& result, const std::vector<LagBlock>& blocks, const Row& lag,
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

void set_stiffness_zero(MicrorheologyResult& result, const std::vector<LagBlock>& blocks, const Row& lag) {
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
    const std::vector<LagBlock> blocks = all_blocks(runs, lags);
    MicrorheologyResult result;
    set_msd(result, runs, lags, blocks);
    const Row lag = well_known(runs, lags, result.lag);
    set_window(result, runs[0].options(), lag.back(), runs[0].interval());
    set_stiffness(result, blocks, lag, runs[0].interval());
    set_stiffness_zero(result, blocks, lag);
    if (std::ranges::all_of(result.msd, [](double v) { return v > 0.0; })) // beads at rest have no kernel
        result.spectrum = stiffness_spectrum(blocks, lag);
    set_spring(result, runs);
    return result;
}

} // namespace rodwake::measure
