#include "rodwake/measure/drift_decay.hpp"

#include "blocks.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace rodwake::measure {

// Correlations of a drift's deviations from its mean, and of a force with the drift before it, summed over
// blocks of time (formulas: rodwake/measure/drift_decay.hpp).

/// Sums over starting times in a block; per lag in whole intervals, from 0.
struct DriftSums {
    std::vector<double> drift; ///< products of velocities, m^2/s^2
    std::vector<double> force; ///< of force and the earlier velocity, W; empty: no rods
    std::vector<double> pairs; ///< products that were added; two components count twice
};

struct DriftBlocks {
    double interval = 0.0;       ///< s
    double run_length = 0.0;     ///< mean of the runs, s
    std::vector<DriftSums> sums; ///< [block]; a last one below half the length is part of the one before
};

/// Lags up to `longest`, s. Paths have at least two points and one interval.
DriftBlocks drift_blocks(std::span<const DriftPath> runs, double longest, double block);

/// Means over all blocks but one; none is left out for without = blocks.size().
struct DriftCorrelation {
    std::vector<double> drift, force; ///< C, m^2/s^2, and K, W; [lag]
};
DriftCorrelation drift_correlation(std::span<const DriftSums> blocks, std::size_t without);

namespace {

using Row = std::vector<double>;
constexpr std::size_t fewest_intervals = 2; // of the window of lags
constexpr double longest_lag = 1.0;         // s; no decay that is slower is looked for

/// Why these paths cannot tell; empty: they may.
std::string absence_of(std::span<const DriftPath> runs, const Estimate& drag_rate,
                       const DriftDecayOptions& o) {
    for (const DriftPath& run : runs) {
        if (run.time.size() < 3)
            return "fewer than 3 frames";
        const Row& t = runs[0].time;
        const double h = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
        constexpr double rounding = 1e-6; // far above that of times, far below a frame
        for (std::size_t i = 1; i < run.time.size(); ++i)
            if (std::abs(run.time[i] - run.time[i - 1] - h) > rounding * h)
                return "frames are not evenly spaced";
        if (h > 0.5 * o.settle * (1.0 + 1e-6))
            return fmt::format(
                "frames are {:.3g} s apart, more than {:.3g} s: the drift decays between them; "
                "shorten measure.interval, or measure phonons too, whose frames then serve",
                h, 0.5 * o.settle);
        if (run.time.back() - run.time.front() < 2.0 * longest_lag)
            return fmt::format("a run of {:.3g} s is shorter than {:.3g} s",
                               run.time.back() - run.time.front(), 2.0 * longest_lag);
        if (!run.impulse_x.empty() && drag_rate.count == 0)
            return "no drag rate by the rods' push, and their force is part of the drift's balance";
    }
    return {};
}

/// Lags between which the balance is drawn, in intervals.
struct LagWindow {
    std::size_t low, high;
};

/// high = 0: C does not fall to a part 1/e of what it is at the first lag.
LagWindow window_of(const Row& drift, double interval, double settle) {
    const auto low = static_cast<std::size_t>(std::lround(settle / interval));
    for (std::size_t k = low + 1; k < drift.size() && drift[low] > 0.0; ++k)
        if (drift[k] <= drift[low] / std::exp(1.0))
            return {low, std::max(k, low + fewest_intervals)};
    return {low, 0};
}

double trapezoid(const Row& values, const LagWindow& w, double interval) {
    double sum = 0.5 * (values[w.low] + values[w.high]);
    for (std::size_t k = w.low + 1; k < w.high; ++k)
        sum += values[k];
    return interval * sum;
}

/// C(t1) - C(t2), J without its bias, and the integral of K over M.
struct Balance {
    double fall, drift, force;

    double rate(double drag_rate) const {
        return force == 0.0 ? fall / drift : drag_rate * fall / (drag_rate * drift - force);
    }
};

/// J gains what taking off the mean of a run of `length` s took from it; the rate is found along with it.
Balance balance_of(const DriftCorrelation& c, const LagWindow& w, double interval, double length, double mass,
                   double drag_rate) {
    constexpr int rounds = 8; // each a tenth of the one before
    const double t1 = interval * static_cast<double>(w.low), t2 = interval * static_cast<double>(w.high);
    const double raw = trapezoid(c.drift, w, interval);
    Balance b{c.drift[w.low] - c.drift[w.high], raw,
              c.force.empty() ? 0.0 : trapezoid(c.force, w, interval) / mass};
    for (int i = 0; i < rounds; ++i) {
        const double rate = b.rate(drag_rate),
                     amplitude = b.fall / (std::exp(-rate * t1) - std::exp(-rate * t2));
        b.drift = raw + 2.0 * amplitude / (rate * length) * (t2 - t1);
    }
    return b;
}

/// Why the error would be none; empty: the header's domain.
std::string outside_domain(double rate, double length, const DriftDecayOptions& o) {
    constexpr double block_decays = 10.0, run_decays = 100.0;
    if (rate * o.block < block_decays)
        return fmt::format("blocks of {:.3g} s are below {:g} decays, {:.2g} s: lengthen measure.block",
                           o.block, block_decays, block_decays / rate);
    if (rate * length < run_decays)
        return fmt::format("{:.3g} s of drift are below {:g} decays, {:.2g} s: run longer, or more runs",
                           length, run_decays, run_decays / rate);
    return {};
}

} // namespace

DriftDecay drift_decay(std::span<const DriftPath> runs, double mass, const Estimate& drag_rate,
                       const DriftDecayOptions& options) {
    if (!(std::isfinite(options.block) && options.block > 0.0 && std::isfinite(options.settle) &&
          options.settle > 0.0))
        throw InputError(
            fmt::format("measure: decay of the drift: blocks of {:g} s and a first lag of {:g} s must be "
                        "finite and positive",
                        options.block, options.settle));
    for (const DriftPath& run : runs) {
        const std::size_t n = run.time.size(), pushes = run.impulse_x.size();
        if (run.x.size() != n || run.y.size() != n || run.impulse_y.size() != pushes ||
            (pushes != 0 && pushes != n))
            throw InputError("measure: decay of the drift: rows of a path differ in length");
    }
    DriftDecay result;
    result.absence = runs.empty() ? "no runs" : absence_of(runs, drag_rate, options);
    if (!result.absence.empty())
        return result;
    const DriftBlocks blocks = drift_blocks(runs, longest_lag, options.block);
    const std::size_t count = blocks.sums.size();
    const DriftCorrelation all = drift_correlation(blocks.sums, count);
    const LagWindow window = window_of(all.drift, blocks.interval, options.settle);
    result.lag_low = blocks.interval * static_cast<double>(window.low);
    result.lag_high = blocks.interval * static_cast<double>(window.high);
    const auto balance = [&](const DriftCorrelation& c) {
        return balance_of(c, window, blocks.interval, blocks.run_length, mass, drag_rate.value);
    };
    const double rate = window.high == 0 ? 0.0 : balance(all).rate(drag_rate.value);
    if (!(std::isfinite(rate) && rate > 0.0))
        result.absence =
            fmt::format("the drift's correlation does not decay between lags of {:.3g} and {:.3g} s",
                        result.lag_low, longest_lag);
    else
        result.absence = outside_domain(rate, blocks.run_length * static_cast<double>(runs.size()), options);
    if (!result.absence.empty())
        return result;
    const Balance whole = balance(all);
    Jackknife parts{{rate, drag_rate.value / rate}, {}};
    for (std::size_t b = 0; count > 1 && b < count; ++b) {
        const double part = balance(drift_correlation(blocks.sums, b)).rate(drag_rate.value);
        parts.without.push_back({part, drag_rate.value / part});
    }
    // without rods the rate does not know drag_rate
    const double by_drag =
        whole.force == 0.0 ? 0.0 : rate / drag_rate.value * (1.0 - rate * whole.drift / whole.fall);
    const double scatter = count > 1 ? parts.error(0) : unknown_error,
                 inertia_scatter = count > 1 ? parts.error(1) : unknown_error;
    result.rate = {rate, std::hypot(scatter, by_drag * drag_rate.error), count};
    if (drag_rate.count > 0) {
        result.inertia = {drag_rate.value / rate,
                          std::hypot(inertia_scatter, whole.drift / whole.fall * drag_rate.error), count};
        result.coupling = whole.force / (drag_rate.value * whole.drift);
    }
    return result;
}

namespace {

/// Rate of change over each interval, less its mean.
Row fluctuations(const Row& values, double interval) {
    Row rates;
    const std::size_t n = values.size() - 1;
    rates.reserve(n);
    const double mean = (values.back() - values.front()) / (interval * static_cast<double>(n));
    for (std::size_t i = 0; i < n; ++i)
        rates.push_back((values[i + 1] - values[i]) / interval - mean);
    return rates;
}

/// Component along (c, s).
Row along(const Row& x, const Row& y, double c, double s) {
    Row out;
    out.reserve(x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
        out.push_back(c * x[i] + s * y[i]);
    return out;
}

} // namespace

DriftBlocks drift_blocks(std::span<const DriftPath> runs, double longest, double block) {
    DriftBlocks out;
    const DriftPath& item = runs[0];
    out.interval = (item.time.back() - item.time.front()) / static_cast<double>(item.time.size() - 1);
    const auto lags = static_cast<std::size_t>(std::lround(longest / out.interval)) + 1,
               length = static_cast<std::size_t>(std::max(1L, std::lround(block / out.interval)));
    for (const DriftPath& run : runs) {
        out.run_length += (run.time.back() - run.time.front()) / static_cast<double>(runs.size());

        // Velocities, one row a component; where rods push, the component along their push, and the force.
        std::vector<Row> velocity;
        Row force;
        if (run.impulse_x.empty()) {
            velocity = {fluctuations(run.x, out.interval), fluctuations(run.y, out.interval)};
        } else {
            const double px = run.impulse_x.back() - run.impulse_x.front(),
                         py = run.impulse_y.back() - run.impulse_y.front(), p = std::hypot(px, py);
            const double c = p > 0.0 ? px / p : 1.0, s = p > 0.0 ? py / p : 0.0;
            velocity = {fluctuations(along(run.x, run.y, c, s), out.interval)};
            force = fluctuations(along(run.impulse_x, run.impulse_y, c, s), out.interval);
        }
        const std::size_t n = velocity[0].size(), count = std::max<std::size_t>(1, (n + length / 2) / length),
                          first = out.sums.size();
        for (std::size_t b = 0; b < count; ++b)
            out.sums.push_back({Row(lags, 0.0), Row(force.empty() ? 0 : lags, 0.0), Row(lags, 0.0)});
        for (std::size_t start = 0; start < n; ++start) {
            DriftSums& sums = out.sums[first + std::min(start / length, count - 1)];
            for (const Row& v : velocity)
                for (std::size_t lag = 0; lag < lags && start + lag < n; ++lag) {
                    sums.drift[lag] += v[start] * v[start + lag];
                    sums.pairs[lag] += 1.0;
                    if (!force.empty())
                        sums.force[lag] += v[start] * force[start + lag];
                }
        }
    }
    return out;
}

DriftCorrelation drift_correlation(std::span<const DriftSums> blocks, std::size_t without) {
    DriftCorrelation c{Row(blocks[0].drift.size(), 0.0), Row(blocks[0].force.size(), 0.0)};
    Row pairs(c.drift.size(), 0.0);
    for (std::size_t b = 0; b < blocks.size(); ++b)
        for (std::size_t lag = 0; b != without && lag < pairs.size(); ++lag) {
            c.drift[lag] += blocks[b].drift[lag];
            pairs[lag] += blocks[b].pairs[lag];
            if (!c.force.empty())
                c.force[lag] += blocks[b].force[lag];
        }
    for (std::size_t lag = 0; lag < pairs.size(); ++lag) {
        c.drift[lag] /= pairs[lag];
        if (!c.force.empty())
            c.force[lag] /= pairs[lag];
    }
    return c;
}

} // namespace rodwake::measure
