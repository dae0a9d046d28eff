#include "decay_points.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

using Block = StructureRecord::Block;

/// Bins [first, last) taken together.
struct Group {
    std::size_t first, last;
};

/// Groups of twice the wanted step, each overlapping half of the next; they begin near `from` and end with
/// the last bin.
std::vector<Group> groups(std::size_t bins, double bin, double from, double step) {
    const double range = static_cast<double>(bins) - from / bin;
    if (!(range >= 1.0))
        return {};
    const auto width = static_cast<std::size_t>(std::max(1.0, std::round(std::min(step / bin, range / 6.0))));
    const auto count =
        std::min(static_cast<std::size_t>(std::round(range / static_cast<double>(width))), bins / width);
    std::vector<Group> all;
    for (std::size_t k = bins - count * width; k < bins; k += width)
        if (k + 2 * width <= bins)
            all.push_back({k, k + 2 * width});
    return all;
}

/// Weight of each bin of a group: sin^2, which passes nothing of a swing as long as half the group or shorter
/// by a whole fraction, and little in between.
std::vector<double> window(const Group& group) {
    std::vector<double> weights;
    const double step = M_PI / static_cast<double>(group.last - group.first);
    for (std::size_t k = 0; k < group.last - group.first; ++k)
        weights.push_back(std::pow(std::sin(step * (static_cast<double>(k) + 0.5)), 2));
    return weights;
}

double over(const std::vector<double>& values, const Group& group, const std::vector<double>& weights) {
    double sum = 0.0;
    for (std::size_t k = group.first; k < group.last; ++k)
        sum += weights[k - group.first] * values[k];
    return sum;
}

struct Sums {
    double pairs = 0.0, order = 0.0;

    double mean() const { return pairs > 0.0 ? order / pairs : 0.0; }
};

} // namespace

double decay_from(const Layout& layout) { return std::min(8.0 * layout.bead_radius, layout.box / 8.0); }

DecayPoints decay_points(const std::vector<Block>& blocks, const Layout& layout, double bin) {
    const double row = std::sqrt(0.5 * std::sqrt(3.0) / static_cast<double>(layout.beads)) * layout.box;
    DecayPoints points;
    points.box = layout.box;
    points.without.resize(blocks.size());
    double correlation = 0.0;
    const auto all = groups(blocks.front().pairs.size(), bin, decay_from(layout), 2.0 * row);
    for (const Group& group : all) {
        const std::vector<double> weight_of = window(group);
        Sums sums;
        double distance = 0.0;
        std::vector<double> values, weights;
        for (const Block& block : blocks) {
            weights.push_back(over(block.pairs, group, weight_of));
            values.push_back(weights.back() > 0.0 ? over(block.fine_order, group, weight_of) / weights.back()
                                                  : 0.0);
            sums.pairs += weights.back();
            sums.order += over(block.fine_order, group, weight_of);
            for (std::size_t k = group.first; k < group.last; ++k)
                distance +=
                    weight_of[k - group.first] * block.pairs[k] * (static_cast<double>(k) + 0.5) * bin;
        }
        for (std::size_t b = 0; b < blocks.size(); ++b)
            points.without[b].push_back(
                Sums{sums.pairs - weights[b], sums.order - over(blocks[b].fine_order, group, weight_of)}
                    .mean());
        const Estimate e = mean_of_blocks(values, weights);
        points.r.push_back(sums.pairs > 0.0 ? distance / sums.pairs : 0.0);
        points.g_B.push_back(e.value);
        points.error.push_back(e.error);
        correlation += successive_correlation(values) / static_cast<double>(all.size());
    }
    points.growth = correlation_factor(correlation);
    for (double& error : points.error)
        error = error > 0.0 ? error * points.growth : error;
    return points;
}

} // namespace rodwake::measure
