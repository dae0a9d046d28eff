#include "phase_samples.hpp"

#include "rodwake/core/error.hpp"

#include "block_scatter.hpp"
#include "first_guess.hpp"
#include "phase_cell.hpp"

#include <fmt/format.h>

namespace rodwake::measure {

namespace {

constexpr double least_contrast = 20.0;

std::vector<Follows> follows_of(const std::vector<PhaseBlock>& blocks) {
    std::vector<Follows> follows;
    for (const PhaseBlock& block : blocks)
        follows.push_back(block.follows);
    return follows;
}

/// Places are those of the beads.
BinSamples of_bins(const std::vector<PhaseBlock>& blocks, std::vector<Vector2> guess, const RodGrid& grid) {
    BinSamples samples(grid.bins());
    samples.value = std::move(guess);
    BlockScatter scatter(grid.bins());
    const auto follows = follows_of(blocks);
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        PhaseCell cell(blocks, {{j, 1.0, {}}});
        const double beads = samples.count[j] = cell.total(PhaseRecord::beads);
        if (!(beads > 0.0))
            continue;
        cell.solve(samples.value[j]);
        scatter.add(j, cell.pulls(samples.value[j]), cell.present(), follows);
        samples.coherence[j] = cell.coherence();
        samples.place[j] = {grid.middle(j % grid.n) + cell.total(PhaseRecord::place_x) / beads,
                            grid.middle(j / grid.n) + cell.total(PhaseRecord::place_y) / beads};
    }
    scatter.finish(samples);
    return samples;
}

/// Places are the centres of the cells' data.
BinSamples of_cells(const std::vector<PhaseBlock>& blocks, const CellWindow& window, const RodGrid& grid) {
    BinSamples samples(grid.bins());
    BlockScatter scatter(grid.bins());
    const auto follows = follows_of(blocks);
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        const CellMean mean = window.around(j);
        samples.place[j] = {grid.middle(j % grid.n) + mean.place.x, grid.middle(j / grid.n) + mean.place.y};
        samples.count[j] = mean.count;
        samples.value[j] = mean.guess;
        if (mean.parts.empty())
            continue;
        PhaseCell cell(blocks, mean.parts);
        cell.solve(samples.value[j]);
        scatter.add(j, cell.pulls(samples.value[j]), cell.present(), follows);
        samples.coherence[j] = cell.coherence();
    }
    scatter.finish(samples);
    return samples;
}

BinSamples at_middles(BinSamples samples, const RodGrid& grid) {
    for (std::size_t j = 0; j < grid.bins(); ++j)
        samples.place[j] = {grid.middle(j % grid.n), grid.middle(j / grid.n)};
    return samples;
}

} // namespace

void want_crystal(std::span<const DisplacementRecord> runs) {
    for (const DisplacementRecord& run : runs) {
        const auto& peaks = std::get<PhaseRecord>(run.impl().sums).peaks();
        if (peaks && peaks->contrast() < least_contrast)
            throw RunError(fmt::format(
                "measure: displacement: no crystal: the largest Bragg peak is {:.3g} times the mean around "
                "it, "
                "needs {:g}; take a denser bed, a longer equilibration or the estimator lagrangian",
                peaks->contrast(), least_contrast));
    }
}

BinSamples phase_samples(std::span<const DisplacementRecord> runs) {
    want_crystal(runs);
    const RodGrid grid(runs[0].layout().box, runs[0].keys().spacing);
    std::vector<std::vector<double>> smoothed;
    const auto blocks = phase_blocks(runs, smoothed);
    const BinSamples single = of_bins(blocks, first_guess(blocks, grid, runs[0].impl().far_from), grid);
    if (runs[0].keys().method == DisplacementMethod::density)
        return single; // has been averaged over a window already
    const double spacing = lattice_spacing(runs[0].layout());
    const BinSamples plain = of_cells(blocks, CellWindow(single, nullptr, grid, spacing), grid);
    // differences across the cell are taken out
    return at_middles(of_cells(blocks, CellWindow(single, &plain, grid, spacing), grid), grid);
}

} // namespace rodwake::measure
