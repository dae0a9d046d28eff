#include "drift_correlation.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;

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

/// Velocities of a run, one row a component, and the force along the first where rods push.
struct Fluctuations {
    std::vector<Row> velocity;
    Row force;
};

Fluctuations of_run(const DriftPath& path, double interval) {
    if (path.impulse_x.empty())
        return {{fluctuations(path.x, interval), fluctuations(path.y, interval)}, {}};
    const double px = path.impulse_x.back() - path.impulse_x.front(),
                 py = path.impulse_y.back() - path.impulse_y.front(), p = std::hypot(px, py);
    const double c = p > 0.0 ? px / p : 1.0, s = p > 0.0 ? py / p : 0.0;
    return {{fluctuations(along(path.x, path.y, c, s), interval)},
            fluctuations(along(path.impulse_x, path.impulse_y, c, s), interval)};
}

DriftSums no_sums(std::size_t lags, bool rods) {
    return {Row(lags, 0.0), Row(rods ? lags : 0, 0.0), Row(lags, 0.0)};
}

void add_start(DriftSums& sums, const Fluctuations& run, std::size_t start) {
    for (const Row& v : run.velocity)
        for (std::size_t lag = 0; lag < sums.drift.size() && start + lag < v.size(); ++lag) {
            sums.drift[lag] += v[start] * v[start + lag];
            sums.pairs[lag] += 1.0;
            if (!run.force.empty())
                sums.force[lag] += v[start] * run.force[start + lag];
        }
}

void add_run(std::vector<DriftSums>& blocks, const Fluctuations& run, std::size_t lags, std::size_t length) {
    const std::size_t n = run.velocity[0].size(), count = std::max<std::size_t>(1, (n + length / 2) / length),
                      first = blocks.size();
    for (std::size_t b = 0; b < count; ++b)
        blocks.push_back(no_sums(lags, !run.force.empty()));
    for (std::size_t start = 0; start < n; ++start)
        add_start(blocks[first + std::min(start / length, count - 1)], run, start);
}

} // namespace

DriftBlocks drift_blocks(std::span<const DriftPath> runs, double longest, double block) {
    DriftBlocks out;
    const DriftPath& one = runs[0];
    out.interval = (one.time.back() - one.time.front()) / static_cast<double>(one.time.size() - 1);
    const auto intervals = [&](double time) {
        return static_cast<std::size_t>(std::lround(time / out.interval));
    };
    for (const DriftPath& run : runs) {
        out.run_length += (run.time.back() - run.time.front()) / static_cast<double>(runs.size());
        add_run(out.sums, of_run(run, out.interval), intervals(longest) + 1,
                std::max<std::size_t>(1, intervals(block)));
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
