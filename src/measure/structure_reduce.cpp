#include "decay_points.hpp"
#include "pair_counts.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/structure.hpp"

#include <algorithm>

namespace rodwake::measure {

namespace {

using Block = StructureRecord::Block;

std::vector<Block> all_blocks(std::span<const StructureRecord> runs) {
    std::vector<Block> blocks;
    for (const StructureRecord& run : runs) {
        if (!(run.keys() == runs.front().keys() && run.layout() == runs.front().layout()))
            throw InputError("measure: runs of different beds or keys cannot be taken together");
        const std::vector<Block> more = run.blocks();
        blocks.insert(blocks.end(), more.begin(), more.end());
    }
    if (blocks.empty())
        throw InputError("measure: no frames to measure order in: is the trajectory empty?");
    return blocks;
}

/// A quantity in each block with its weight.
struct Series {
    std::vector<double> values, weights;
};

template<class Value, class Weight>
Series series(const std::vector<Block>& blocks, Value value, Weight weight) {
    Series s;
    for (const Block& block : blocks)
        if (const double w = weight(block); w > 0.0) {
            s.values.push_back(value(block) / w);
            s.weights.push_back(w);
        }
    return s;
}

constexpr auto frames_of = [](const Block& block) { return block.frames; };

Estimate estimate(const Series& s, double growth) {
    Estimate e = mean_of_blocks(s.values, s.weights);
    if (e.known())
        e.error *= growth;
    return e;
}

Estimate over_blocks(const std::vector<Block>& blocks, double Block::*sum) {
    const Series s = series(
        blocks, [sum](const Block& block) { return block.*sum; }, frames_of);
    return estimate(s, correlation_factor(successive_correlation(s.values)));
}

/// Blocks of all bins fluctuate together, and few of them tell little about one bin: one factor for all.
double common_growth(const std::vector<Series>& bins) {
    double sum = 0.0, count = 0.0;
    for (const Series& s : bins) {
        sum += successive_correlation(s.values);
        count += 1.0;
    }
    return count > 0.0 ? correlation_factor(sum / count) : 1.0;
}

void reduce_g(const std::vector<Block>& blocks, const StructureRecord& run, StructureResult& result) {
    const std::size_t bins = blocks.front().pairs.size(), beads = run.layout().beads;
    const double box = run.layout().box, bin = run.keys().bin, frames = static_cast<double>(result.frames);
    const std::vector<double> of_one = pair_correlation(std::vector<double>(bins, 1.0), 1.0, beads, box, bin);
    std::vector<Series> all;
    for (std::size_t k = 0; k < bins; ++k)
        all.push_back(series(
            blocks, [&](const Block& b) { return b.pairs[k] * of_one[k]; }, frames_of));
    const double growth = common_growth(all);
    result.r = middles(bins, bin);
    for (std::size_t k = 0; k < bins; ++k) {
        const Estimate e = estimate(all[k], growth);
        result.g.push_back(e.value);
        // no pair in any frame: as much as one pair would make
        result.g_error.push_back(e.value == 0.0 ? of_one[k] / frames : e.error);
    }
}

void reduce_order(const std::vector<Block>& blocks, const StructureRecord& run, StructureResult& result) {
    std::vector<Series> all;
    for (std::size_t k = 0; k < blocks.front().order.size(); ++k) {
        Series s = series(
            blocks, [k](const Block& b) { return b.order[k]; },
            [k](const Block& b) { return b.order_pairs[k]; });
        if (s.values.empty())
            continue;
        double pairs = 0.0;
        for (const double weight : s.weights)
            pairs += weight;
        result.order_r.push_back((static_cast<double>(k) + 0.5) * run.keys().order_bin);
        result.order_pairs.push_back(pairs);
        all.push_back(std::move(s));
    }
    const double growth = common_growth(all);
    for (const Series& s : all) {
        const Estimate e = estimate(s, growth);
        result.g_B.push_back(e.value);
        result.g_B_error.push_back(e.error);
    }
}

void reduce_cutoff(std::span<const StructureRecord> runs, StructureResult& result) {
    double sum = 0.0, count = 0.0;
    for (const StructureRecord& run : runs) {
        const Cutoff cutoff = run.settled_cutoff();
        result.cutoffs_by_spacing += cutoff.by_spacing;
        sum += cutoff.value;
        count += cutoff.value > 0.0;
    }
    result.cutoff = count > 0.0 ? sum / count : 0.0;
}

} // namespace

StructureResult reduce(std::span<const StructureRecord> runs) {
    const std::vector<Block> blocks = all_blocks(runs);
    const StructureRecord& run = runs.front();
    StructureResult result;
    result.blocks = blocks.size();
    for (const Block& block : blocks)
        result.frames += static_cast<std::size_t>(block.frames);
    result.psi6 = over_blocks(blocks, &Block::psi6);
    result.local_psi6 = over_blocks(blocks, &Block::local);
    result.neighbours = over_blocks(blocks, &Block::neighbours);
    reduce_g(blocks, run, result);
    reduce_order(blocks, run, result);
    reduce_cutoff(runs, result);
    result.g_minimum = first_minimum(result.r, result.g, run.layout().bead_radius);
    result.decay = classify(decay_points(blocks, run.layout(), run.keys().bin), 0.0);
    return result;
}

} // namespace rodwake::measure
