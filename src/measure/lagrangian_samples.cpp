#include "lagrangian_samples.hpp"

#include "block_scatter.hpp"
#include "cell_window.hpp"

#include <array>

namespace rodwake::measure {

namespace {

using Record = LagrangianRecord;
using Sums = std::array<double, Record::channels>;

struct Sources {
    std::vector<const BlockSums*> blocks;
    std::vector<Follows> follows;
};

Sources sources_of(std::span<const DisplacementRecord> runs) {
    Sources sources;
    for (const DisplacementRecord& run : runs)
        for (const BlockSums* before = nullptr;
             const BlockSums& block : std::get<Record>(run.impl().sums).blocks()) {
            sources.follows.push_back(follows_of(before, block));
            sources.blocks.push_back(&block);
            before = &block;
        }
    return sources;
}

/// Sums of a block over some bins, the displacements of each bin taken back by what U differs there.
Sums sums_of(const BlockSums& block, const std::vector<CellPart>& parts) {
    Sums total{};
    for (const CellPart& part : parts) {
        const double* from = &block.sums[part.bin * Record::channels];
        for (std::size_t c = 0; c < Record::channels; ++c)
            total[c] += part.weight * from[c];
        total[Record::along] -= part.weight * from[Record::beads] * part.difference.x;
        total[Record::across] -= part.weight * from[Record::beads] * part.difference.y;
    }
    return total;
}

/// Value and place (from the bin's middle) of the mean; adds to the scatter.
void put(const Sources& sources, std::size_t bin, const std::vector<CellPart>& parts, BinSamples& samples,
         BlockScatter& scatter) {
    std::vector<Sums> blocks;
    Sums total{};
    for (const BlockSums* block : sources.blocks) {
        blocks.push_back(sums_of(*block, parts));
        for (std::size_t c = 0; c < Record::channels; ++c)
            total[c] += blocks.back()[c];
    }
    const double beads = total[Record::beads];
    const Vector2 mean{total[Record::along] / beads, total[Record::across] / beads};
    std::vector<Vector2> pulls;
    std::vector<bool> present;
    for (const Sums& block : blocks) {
        pulls.push_back({(block[Record::along] - block[Record::beads] * mean.x) / beads,
                         (block[Record::across] - block[Record::beads] * mean.y) / beads});
        present.push_back(block[Record::beads] > 0.0);
    }
    samples.value[bin] = mean;
    samples.coherence[bin] = 1.0;
    samples.place[bin].x += total[Record::place_x] / beads;
    samples.place[bin].y += total[Record::place_y] / beads;
    scatter.add(bin, pulls, present, sources.follows);
}

double beads_in(const Sources& sources, std::size_t bin) {
    double beads = 0.0;
    for (const BlockSums* block : sources.blocks)
        beads += block->sums[bin * Record::channels + Record::beads];
    return beads;
}

Vector2 middle(const RodGrid& grid, std::size_t bin) {
    return {grid.middle(bin % grid.n), grid.middle(bin / grid.n)};
}

BinSamples of_bins(const Sources& sources, const RodGrid& grid) {
    BinSamples samples(grid.bins());
    BlockScatter scatter(grid.bins());
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        samples.place[j] = middle(grid, j);
        samples.count[j] = beads_in(sources, j);
        if (samples.count[j] > 0.0)
            put(sources, j, {{j, 1.0, {}}}, samples, scatter);
    }
    scatter.finish(samples);
    return samples;
}

BinSamples of_cells(const Sources& sources, const CellWindow& window, const RodGrid& grid) {
    BinSamples samples(grid.bins());
    BlockScatter scatter(grid.bins());
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        const CellMean mean = window.around(j);
        samples.count[j] = mean.count;
        if (!mean.parts.empty())
            put(sources, j, mean.parts, samples, scatter);
        samples.place[j] = {middle(grid, j).x + mean.place.x, middle(grid, j).y + mean.place.y};
    }
    scatter.finish(samples);
    return samples;
}

} // namespace

BinSamples lagrangian_samples(std::span<const DisplacementRecord> runs) {
    const RodGrid grid(runs[0].layout().box, runs[0].keys().spacing);
    const double spacing = lattice_spacing(runs[0].layout());
    const Sources sources = sources_of(runs);
    const BinSamples single = of_bins(sources, grid);
    const BinSamples plain = of_cells(sources, CellWindow(single, nullptr, grid, spacing), grid);
    BinSamples samples = of_cells(sources, CellWindow(single, &plain, grid, spacing), grid);
    for (std::size_t j = 0; j < grid.bins(); ++j) // differences across the cell were taken out
        samples.place[j] = middle(grid, j);
    return samples;
}

} // namespace rodwake::measure
