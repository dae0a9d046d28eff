#include "phase_blocks.hpp"

#include "cell_window.hpp"
#include "density_record.hpp"

namespace rodwake::measure {

namespace {

PhaseBlock lattice_of(const BraggPeaks& peaks, const BlockSums& block, Follows follows) {
    PhaseBlock made;
    made.m = peaks.m;
    made.n = peaks.n;
    made.heading = block.heading();
    made.frames = block.frames;
    made.follows = follows;
    return made;
}

} // namespace

std::vector<PhaseBlock> phase_blocks(std::span<const DisplacementRecord> runs,
                                     std::vector<std::vector<double>>& smoothed) {
    std::vector<PhaseBlock> blocks;
    for (const DisplacementRecord& run : runs) {
        const auto& record = std::get<PhaseRecord>(run.impl().sums);
        const RodGrid grid(run.layout().box, run.keys().spacing);
        const BlockSums* before = nullptr;
        for (const BlockSums& block : record.blocks()) {
            PhaseBlock made = lattice_of(*record.peaks(), block, follows_of(before, block));
            before = &block;
            if (run.keys().method == DisplacementMethod::density) {
                made.g = seen_along(record.peaks()->G, block.first_heading);
                smoothed.push_back(
                    windowed_density(block, grid, lattice_spacing(run.layout()), run.impl().far_from));
                made.sums = smoothed.back(); // a moved vector keeps its values in place
            } else {
                made.g = seen_along(record.peaks()->G, made.heading);
                made.sums = block.sums;
            }
            blocks.push_back(made);
        }
    }
    return blocks;
}

} // namespace rodwake::measure
