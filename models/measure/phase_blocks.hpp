#pragma once
// The blocks of all runs of an estimator with phases, ready to be put together.

#include "blocks.hpp"
#include "displacement_impl.hpp"

#include <array>
#include <span>
#include <vector>

namespace rodwake::measure {

struct PhaseBlock {
    std::span<const double> sums; ///< [bin][PhaseAccumulator::channels]
    std::array<Vector2, 3> g;     ///< along the rod's axes
    std::array<int, 3> m{}, n{};  ///< of the lattice
    double heading = 0.0, frames = 0.0;
    Follows follows = Follows::nothing;
};

/// `smoothed` holds the sums of those that are made new: for `density` the far field's phases of each block
/// are taken off and the sums are averaged over a window wider than the lattice spacing.
std::vector<PhaseBlock> phase_blocks(std::span<const DisplacementAccumulator> runs,
                                     std::vector<std::vector<double>>& smoothed);

} // namespace rodwake::measure
