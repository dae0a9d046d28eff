#include "rodwake/measure/order.hpp"
#include "pair_counts.hpp"
#include "psi6.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace rodwake::measure {

namespace {

using OrderBlock = OrderAccumulator::OrderBlock;

/// Bins [first, last) taken together.
struct BinGroup {
    std::size_t first, last;
};

/// Groups of twice the wanted step, each overlapping half of the next; they begin near `from` and end with
/// the last bin.
std::vector<BinGroup> groups(std::size_t bins, double bin, double from, double step) {
    const double range = static_cast<double>(bins) - from / bin;
    if (!(range >= 1.0))
        return {};
    const auto width = static_cast<std::size_t>(std::max(1.0, std::round(std::min(step / bin, range / 6.0))));
    const auto count =
        std::min(static_cast<std::size_t>(std::round(range / static_cast<double>(width))), bins / width);
    std::vector<BinGroup> all;
    for (std::size_t k = bins - count * width; k < bins; k += width)
        if (k + 2 * width <= bins)
            all.push_back({k, k + 2 * width});
    return all;
}

/// g_B(r) weighted by pairs in smooth windows of four lattice rows, in steps of two (less in boxes too small
/// for six such): g_B swings with the rows, and whole swings cancel in bins finer than those shown.
/// Neighbouring points share pairs. The same with each block left out in turn. `bin`: of g(r), m.
DecayPoints decay_points(const std::vector<OrderBlock>& blocks, const Layout& layout, double bin) {
    const double side = layout.window ? std::sqrt(seen_area(layout)) : layout.box.mean_side(),
                 row = std::sqrt(0.5 * std::sqrt(3.0) / static_cast<double>(layout.beads)) * side;
    DecayPoints points;
    if (!layout.window)
        points.box = layout.box;
    points.without.resize(blocks.size());
    double correlation = 0.0;
    // The decay begins at 8 a, where the shells and the 1/r^2 of phonons have faded, but at most at L/8.
    const double from = std::min(8.0 * layout.bead_radius, layout.box.shorter() / 8.0);
    const auto all = groups(blocks.front().pairs.size(), bin, from, 2.0 * row);
    for (const BinGroup& group : all) {
        // Weights sin^2 of the bins cancel swings whose length is half the group or a whole fraction of that,
        // and pass little of those in between.
        std::vector<double> weight_of;
        const double angle = M_PI / static_cast<double>(group.last - group.first);
        for (std::size_t k = 0; k < group.last - group.first; ++k)
            weight_of.push_back(std::pow(std::sin(angle * (static_cast<double>(k) + 0.5)), 2));
        const auto weighted_sum = [&](const std::vector<double>& bins) {
            double sum = 0.0;
            for (std::size_t k = group.first; k < group.last; ++k)
                sum += weight_of[k - group.first] * bins[k];
            return sum;
        };
        const auto mean = [](double order, double pairs) { return pairs > 0.0 ? order / pairs : 0.0; };
        double pairs = 0.0, order = 0.0, distance = 0.0;
        std::vector<double> values, weights, orders;
        for (const OrderBlock& block : blocks) {
            weights.push_back(weighted_sum(block.pairs));
            orders.push_back(weighted_sum(block.fine_order));
            values.push_back(mean(orders.back(), weights.back()));
            pairs += weights.back();
            order += orders.back();
            for (std::size_t k = group.first; k < group.last; ++k)
                distance +=
                    weight_of[k - group.first] * block.pairs[k] * (static_cast<double>(k) + 0.5) * bin;
        }
        for (std::size_t b = 0; b < blocks.size(); ++b)
            points.without[b].push_back(mean(order - orders[b], pairs - weights[b]));
        const Estimate e = mean_of_blocks(values, weights);
        points.r.push_back(mean(distance, pairs));
        points.g_B.push_back(e.value);
        points.error.push_back(e.error);
        correlation += successive_correlation(values) / static_cast<double>(all.size());
    }
    points.growth = correlation_factor(correlation);
    for (double& error : points.error)
        error = error > 0.0 ? error * points.growth : error;
    return points;
}

std::vector<OrderBlock> all_blocks(std::span<const OrderAccumulator> runs) {
    std::vector<OrderBlock> blocks;
    for (const OrderAccumulator& run : runs) {
        if (!(run.options() == runs.front().options() && run.layout() == runs.front().layout()))
            throw InputError("measure: runs of different beds or options cannot be taken together");
        const std::vector<OrderBlock> more = run.blocks();
        blocks.insert(blocks.end(), more.begin(), more.end());
    }
    if (blocks.empty() && !runs.empty() && runs[0].layout().window && runs[0].settled_cutoff().value > 0.0)
        throw InputError(fmt::format("measure: order: no bead is farther than the cut-off of {:.3g} a from "
                                     "the border of the window; a larger window, or a smaller "
                                     "measure.order_cutoff, is needed",
                                     runs[0].settled_cutoff().value / runs[0].layout().bead_radius));
    if (blocks.empty())
        throw InputError("measure: no frames to measure order in: is the trajectory empty?");
    // Two frames of a film, each a block, have a difference, but no scatter.
    if (!runs[0].layout().velocities && blocks.size() == 2 && blocks[0].frames + blocks[1].frames < 3.0) {
        for (const auto sums :
             {&OrderBlock::pairs, &OrderBlock::order_pairs, &OrderBlock::order, &OrderBlock::fine_order,
              &OrderBlock::weighted, &OrderBlock::kind_pairs, &OrderBlock::kind_pairs_in_all})
            std::ranges::transform(blocks[0].*sums, blocks[1].*sums, (blocks[0].*sums).begin(), std::plus{});
        for (const auto sum : {&OrderBlock::psi6, &OrderBlock::local, &OrderBlock::neighbours,
                               &OrderBlock::frames, &OrderBlock::full_frames, &OrderBlock::at_border})
            blocks[0].*sum += blocks[1].*sum;
        blocks.pop_back();
    }
    return blocks;
}

/// A quantity in each block with its weight; blocks without weight are left out.
struct WeightedSeries {
    std::vector<double> values, weights;

    void add(double sum, double weight) {
        if (!(weight > 0.0))
            return;
        values.push_back(sum / weight);
        weights.push_back(weight);
    }
};

Estimate estimate(const WeightedSeries& s, double growth) {
    Estimate e = mean_of_blocks(s.values, s.weights);
    if (e.known())
        e.error *= growth;
    return e;
}

Estimate over_blocks(const std::vector<OrderBlock>& blocks, double OrderBlock::*sum) {
    WeightedSeries s;
    for (const OrderBlock& block : blocks)
        s.add(block.*sum, block.frames);
    return estimate(s, correlation_factor(successive_correlation(s.values)));
}

/// One factor for all bins: their blocks fluctuate together, and few of them say little about one bin.
double common_growth(const std::vector<WeightedSeries>& bins) {
    double sum = 0.0, count = 0.0;
    for (const WeightedSeries& s : bins) {
        sum += successive_correlation(s.values);
        count += 1.0;
    }
    return count > 0.0 ? correlation_factor(sum / count) : 1.0;
}

/// Writes g of each bin. A bin without a pair in any of the `frames` has the error of one pair, which alone
/// would make g `of_one`.
void set_g(const std::vector<WeightedSeries>& bins, const std::vector<double>& of_one, double frames,
           std::vector<double>& g, std::vector<double>& error) {
    const double growth = common_growth(bins);
    for (std::size_t k = 0; k < bins.size(); ++k) {
        const Estimate e = estimate(bins[k], growth);
        g.push_back(e.value);
        error.push_back(e.value == 0.0 ? of_one[k] / frames : e.error);
    }
}

/// g(r) of all beads, then of each pair of kinds. The weight of a block is the number of frames of all beads
/// that would have as many pairs.
void reduce_g(const std::vector<OrderBlock>& blocks, const OrderAccumulator& run, OrderResult& result) {
    const std::size_t bins = blocks.front().pairs.size(), kinds = run.layout().kind_radii.size();
    const double bin = run.options().bin, area = seen_area(run.layout());
    const std::vector<double> ones(bins, 1.0);
    const std::vector<double> of_one = pair_correlation(ones, 1.0, run.layout().beads, area, bin);
    const bool weighted = run.layout().window.has_value();
    std::vector<WeightedSeries> all(bins);
    for (std::size_t k = 0; k < bins; ++k)
        for (const OrderBlock& b : blocks)
            all[k].add((weighted ? b.weighted[k] : b.pairs[k]) * of_one[k], b.full_frames);
    result.r = middles(bins, bin);
    set_g(all, of_one, static_cast<double>(result.frames), result.g, result.g_error);

    const std::vector<double> of_pair = pair_correlation(ones, 1.0, 2, area, bin);
    for (std::size_t p = 0, pair = 0; p < kinds; ++p)
        for (std::size_t q = p; q < kinds; ++q, ++pair) {
            std::vector<WeightedSeries> of_kinds(bins);
            double weight = 0.0;
            for (const OrderBlock& b : blocks) {
                weight += b.kind_pairs_in_all[pair];
                for (std::size_t k = 0; k < bins; ++k)
                    of_kinds[k].add(b.kind_pairs[pair * bins + k] * of_pair[k], b.kind_pairs_in_all[pair]);
            }
            if (weight == 0.0) // fewer than two beads
                continue;
            KindCorrelation& found = result.kinds.emplace_back(KindCorrelation{p, q, {}, {}});
            set_g(of_kinds, of_pair, weight, found.g, found.g_error);
        }
}

void reduce_order(const std::vector<OrderBlock>& blocks, const OrderAccumulator& run, OrderResult& result) {
    std::vector<WeightedSeries> all;
    for (std::size_t k = 0; k < blocks.front().order.size(); ++k) {
        WeightedSeries s;
        for (const OrderBlock& b : blocks)
            s.add(b.order[k], b.order_pairs[k]);
        if (s.values.empty())
            continue;
        double pairs = 0.0;
        for (const double weight : s.weights)
            pairs += weight;
        result.order_r.push_back((static_cast<double>(k) + 0.5) * run.options().order_bin);
        result.order_pairs.push_back(pairs);
        all.push_back(std::move(s));
    }
    const double growth = common_growth(all);
    for (const WeightedSeries& s : all) {
        const Estimate e = estimate(s, growth);
        result.g_B.push_back(e.value);
        result.g_B_error.push_back(e.error);
    }
}

} // namespace

OrderResult reduce(std::span<const OrderAccumulator> runs) {
    const std::vector<OrderBlock> blocks = all_blocks(runs);
    const OrderAccumulator& run = runs.front();
    OrderResult result;
    result.blocks = blocks.size();
    for (const OrderBlock& block : blocks)
        result.frames += static_cast<std::size_t>(block.frames);
    result.psi6 = over_blocks(blocks, &OrderBlock::psi6);
    result.local_psi6 = over_blocks(blocks, &OrderBlock::local);
    result.neighbours = over_blocks(blocks, &OrderBlock::neighbours);
    if (run.layout().window)
        result.at_border = over_blocks(blocks, &OrderBlock::at_border).value;
    reduce_g(blocks, run, result);
    reduce_order(blocks, run, result);

    double sum = 0.0, count = 0.0;
    for (const OrderAccumulator& each : runs) {
        const Cutoff cutoff = each.settled_cutoff();
        result.cutoffs_by_spacing += cutoff.by_spacing;
        sum += cutoff.value;
        count += cutoff.value > 0.0;
    }
    result.cutoff = count > 0.0 ? sum / count : 0.0;
    result.g_minimum = first_minimum(result.r, result.g, run.layout().bead_radius);
    result.decay = classify(decay_points(blocks, run.layout(), run.options().bin), 0.0);

    // The noise of a camera weakens psi_6 by a known factor, and g_B and its plateau by the square of that.
    if (run.options().localisation > 0.0) {
        const double loss = bond_loss(result.r, result.g, result.cutoff, run.options().localisation);
        result.psi6 = result.psi6.scaled(1.0 / loss);
        for (std::vector<double>* values : {&result.g_B, &result.g_B_error})
            for (double& value : *values)
                value /= loss * loss;
        result.decay.plateau = result.decay.plateau.scaled(1.0 / (loss * loss));
    }
    return result;
}

} // namespace rodwake::measure
