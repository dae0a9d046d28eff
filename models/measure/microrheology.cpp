#include "rodwake/measure/microrheology.hpp"
#include "blocks.hpp"
#include "laplace.hpp"
#include "rodwake/core/error.hpp"
#include "stiffness_spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
using Runs = MicrorheologyRuns;
constexpr std::size_t fewest_frames = 32, window_points = 16;

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

/// The range of s for s -> 0. Below 1/t_max the tail dominates the transform, above half a frame's rate the
/// straight piece from lag 0 to the first lag.
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

/// {value of the straight line through the curve at s = 0, error from the bend of the curve}. A part c s^2 of
/// the curve puts the line through s_1 and s_2 off by -c s_1 s_2 at 0, and so the line through the lower half
/// of the points off by less.
Row extrapolated(const Row& s, const Row& stiffness, const Row& errors) {
    const auto at_zero = [&](std::size_t points) {
        const auto first = [&](const Row& row) { return std::span(row).first(points); };
        return fit_line(first(s), first(stiffness), first(errors)).intercept.value;
    };
    const std::size_t lower = s.size() / 2;
    const double whole = at_zero(s.size()), half = at_zero(lower);
    return {whole, (whole - half) / (1.0 - s[lower - 1] / s.back())};
}

/// All results that follow from the displacements of these blocks.
void set_curves(MicrorheologyResult& result, const std::vector<LagBlock>& blocks, const Row& lag,
                double interval) {
    const Jackknife msd = Jackknife::of(blocks, [](const Row& curve) { return curve; });
    result.msd = msd.all;
    result.msd_error = msd.errors();
    if (lag.empty())
        return;
    const double octaves = std::log2(2.0 * lag.back() / interval);
    result.s =
        log_range(0.5 / lag.back(), 1.0 / interval, 1 + static_cast<std::size_t>(std::ceil(4.0 * octaves)));
    const Jackknife curves =
        Jackknife::of(blocks, [&](const Row& curve) { return stiffness_curve(lag, curve, result.s); });
    result.stiffness = curves.all;
    result.stiffness_error = curves.errors();

    // The stiffness at s -> 0, with each block left out in turn.
    const Row s = log_range(result.s_low, result.s_high, window_points);
    const Jackknife low =
        Jackknife::of(blocks, [&](const Row& curve) { return stiffness_curve(lag, curve, s); });
    Row errors = low.errors();
    for (std::size_t i = 0; i < s.size(); ++i) // blocks that agree to round-off still weigh the points
        errors[i] = std::max(errors[i], 1e-12 * low.all[i]);
    Jackknife zero{extrapolated(s, low.all, errors), {}};
    for (const Row& curve : low.without)
        zero.without.push_back(extrapolated(s, curve, errors));
    const double bend = zero.all[1], noise = zero.error(1);
    result.bend = std::sqrt(std::max(0.0, bend * bend - noise * noise));
    result.scatter = zero.error(0);
    result.stiffness_zero = {zero.all[0], std::hypot(result.scatter, result.bend), blocks.size()};
    if (std::ranges::all_of(result.msd, [](double v) { return v > 0.0; })) // beads at rest have no kernel
        result.spectrum = stiffness_spectrum(blocks, lag);
}

/// Adds the distance of another result to the errors.
void widen(MicrorheologyResult& result, const MicrorheologyResult& other) {
    const auto widen_row = [](Row& errors, const Row& values, const Row& others) {
        for (std::size_t i = 0; i < std::min(errors.size(), others.size()); ++i)
            errors[i] = std::hypot(errors[i], values[i] - others[i]);
    };
    widen_row(result.msd_error, result.msd, other.msd);
    widen_row(result.stiffness_error, result.stiffness, other.stiffness);
    widen_row(result.spectrum.error, result.spectrum.value, other.spectrum.value);
    if (!result.no_stiffness.empty())
        return;
    result.scatter = std::hypot(result.scatter, result.stiffness_zero.value - other.stiffness_zero.value);
    result.stiffness_zero.error = std::hypot(result.scatter, result.bend);
}

/// Results without the displacement that the camera adds.
void set_tracked_curves(MicrorheologyResult& result, std::vector<LagBlock> blocks, const Row& lag,
                        const MicrorheologyAccumulator& run) {
    // Mean-square displacement that the camera adds, m^2, with its error; 0 without one.
    bool from_one = result.lag.size() >= 6; // the first lags are those of 1 to 6 frames
    for (std::size_t k = 1; k < 6 && from_one; ++k)
        from_one = std::abs(result.lag[k] / result.lag[0] - static_cast<double>(k + 1)) < 1e-6;
    const std::optional<Estimate> found = from_one ? camera_noise(blocks) : std::nullopt;
    if (found) {
        const double added = std::max(found->value, 0.0), sigma = 0.5 * std::sqrt(added);
        result.localisation = {sigma, 0.5 * std::sqrt(added + found->error) - sigma, found->count};
    }
    const auto& camera = run.options().localisation;
    const Estimate b = camera.find ? found.value_or(Estimate{0.0, 0.0, 1})
                                   : Estimate{4.0 * std::pow(camera.given, 2), 0.0, 1};
    result.taken_off = b.value;
    take_off(blocks, b.value);
    const Row left = pooled(blocks, blocks.size());
    const auto known = lag.empty() ? std::ssize(left) : std::ssize(lag);
    const auto least = std::ranges::min_element(left.begin(), left.begin() + known);
    if (b.value > 0.0 && *least <= 0.0)
        throw InputError(fmt::format(
            "measure: microrheology: localisation of {:.3g} a adds as much to the displacement over {:.3g} s "
            "as there is: nothing of the beads is left; correct tracks.localisation, or leave microrheology "
            "out",
            0.5 * std::sqrt(b.value) / run.layout().bead_radius, result.lag[least - left.begin()]));
    set_curves(result, blocks, lag, run.interval());
    MicrorheologyResult other = result;
    if (b.error > 0.0) {
        std::vector<LagBlock> lower = blocks;
        take_off(lower, std::min(b.error, 0.5 * *least));
        set_curves(other, lower, lag, run.interval());
        widen(result, other);
    }
    if (result.hidden.empty())
        return;
    for (LagBlock& block : blocks)
        for (std::size_t i = 0; i < block.sum.size(); ++i)
            block.sum[i] += block.weight[i] * result.hidden[i];
    set_curves(other, blocks, lag, run.interval());
    widen(result, other);
}

} // namespace

void MicrorheologyResult::use_temperature(double T) {
    spring = spring.scaled(T / temperature);
    temperature = T;
}

MicrorheologyResult reduce(Runs runs) {
    // All runs must be alike.
    if (runs.empty())
        throw InputError("measure: microrheology: no runs");
    for (const MicrorheologyAccumulator& run : runs) {
        if (!(run.options() == runs[0].options()) || !(run.layout() == runs[0].layout()))
            throw InputError("measure: microrheology: the runs were measured with different options or beds");
        if (std::abs(run.interval() - runs[0].interval()) > 1e-6 * runs[0].interval())
            throw InputError(
                fmt::format("measure: microrheology: frames are {:g} s apart in one run and {:g} s in "
                            "another: must be the same",
                            runs[0].interval(), run.interval()));
    }
    const bool is_film = !runs[0].layout().velocities;
    const std::vector<long> lags = common_lags(runs);
    if (is_film && lags.empty())
        throw InputError(
            "measure: microrheology: no bead is in two frames: are ids of particles in the file, "
            "or tracks linked?");
    const std::vector<LagBlock> blocks = all_blocks(runs, lags);

    // Lags with their origins, and of runs that see a part the displacement that the drift may hide.
    MicrorheologyResult result;
    for (const long key : lags) {
        double origins = 0.0, sum = 0.0, count = 0.0;
        for (const MicrorheologyAccumulator& run : runs) {
            origins += run.lags().at(key).origins;
            sum += run.lags().at(key).halves;
            count += run.lags().at(key).halves_origins;
        }
        result.lag.push_back(runs[0].lag(key));
        result.origins.push_back(origins);
        if (runs[0].sees_a_part())
            result.hidden.push_back(count > 0.0 ? sum / count : 0.0);
    }

    // Without enough frames there is no stiffness; a film may still have displacements.
    Row lag;
    try {
        for (const MicrorheologyAccumulator& run : runs)
            if (run.frames() < fewest_frames)
                throw InputError(fmt::format(
                    "measure: microrheology of {} frames: needs at least {} a run; write frames more "
                    "often or run longer",
                    run.frames(), fewest_frames));
        lag = well_known(runs, lags);
        set_window(result, runs[0].options(), lag.back(), runs[0].interval());
    } catch (const InputError& error) {
        if (!is_film)
            throw;
        lag.clear();
        result.no_stiffness = error.what();
        result.s_low = result.s_high = result.scatter = result.bend = unknown_error;
    }
    if (!is_film)
        set_curves(result, blocks, lag, runs[0].interval());
    else
        set_tracked_curves(result, blocks, lag, runs[0]);

    // The spring constant from the stiffness and the mean temperature.
    double sum = 0.0;
    for (const MicrorheologyAccumulator& run : runs) {
        sum += run.temperature() * static_cast<double>(run.frames());
        result.frames += run.frames();
    }
    result.temperature = sum / static_cast<double>(result.frames);
    if (runs[0].layout().velocities && runs[0].layout().kind_radii.empty()) // else beads have several masses
        result.spring = result.stiffness_zero.scaled(4.0 * runs[0].layout().bead_mass * result.temperature);
    return result;
}

} // namespace rodwake::measure
