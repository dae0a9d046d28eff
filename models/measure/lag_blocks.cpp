#include "lag_blocks.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
constexpr auto channels = MicrorheologyAccumulator::channels, groups = MicrorheologyAccumulator::groups;
constexpr std::size_t fewest_runs = 4;

LagBlock block(const MicrorheologyAccumulator& run, const std::vector<Lag>& lags, std::size_t first,
               std::size_t end) {
    LagBlock b{Row(lags.size(), 0.0), Row(lags.size(), 0.0)};
    for (std::size_t i = 0; i < lags.size(); ++i)
        for (std::size_t g = first; g < end; ++g) {
            b.sum[i] += run.levels()[lags[i].level].sum[lags[i].channel * groups + g];
            b.weight[i] += origins(run, lags[i]) * run.group_sizes()[g];
        }
    return b;
}

} // namespace

double origins(const MicrorheologyAccumulator& run, Lag lag) {
    return lag.level < run.levels().size() ? run.levels()[lag.level].origins[lag.channel] : 0.0;
}

std::vector<Lag> common_lags(MicrorheologyRuns runs) {
    std::vector<Lag> lags;
    for (std::size_t level = 0; level < runs[0].levels().size(); ++level)
        for (std::size_t c = level == 0 ? 0 : channels / 2; c < channels; ++c)
            if (std::ranges::all_of(runs, [&](const auto& run) { return origins(run, {level, c}) > 0.0; }))
                lags.push_back({level, c});
    return lags;
}

Row well_known(MicrorheologyRuns runs, const std::vector<Lag>& lags, const Row& seconds) {
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

std::vector<LagBlock> all_blocks(MicrorheologyRuns runs, const std::vector<Lag>& lags) {
    std::vector<LagBlock> blocks;
    const std::size_t step = runs.size() >= fewest_runs ? groups : 1;
    blocks.reserve(runs.size() * groups / step);
    for (const MicrorheologyAccumulator& run : runs)
        for (std::size_t g = 0; g < groups; g += step)
            blocks.push_back(block(run, lags, g, g + step));
    return blocks;
}

Row pooled(const std::vector<LagBlock>& blocks, std::size_t without) {
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

double Jackknife::error(std::size_t i) const {
    const double n = static_cast<double>(without.size());
    double mean = 0.0, scatter = 0.0;
    for (const Row& curve : without)
        mean += curve[i] / n;
    for (const Row& curve : without)
        scatter += (curve[i] - mean) * (curve[i] - mean);
    return std::sqrt(scatter * (n - 1.0) / n);
}

Row Jackknife::errors() const {
    Row row;
    for (std::size_t i = 0; i < all.size(); ++i)
        row.push_back(error(i));
    return row;
}

Row log_range(double low, double high, std::size_t points) {
    Row range;
    for (std::size_t i = 0; i < points; ++i)
        range.push_back(low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(points - 1)));
    return range;
}

} // namespace rodwake::measure
