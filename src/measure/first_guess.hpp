#pragma once
// Unwrapped displacement in each bin, from the pooled phases of the largest set of blocks with one lattice
// and nearly one heading.

#include "phase_blocks.hpp"

#include <vector>

namespace rodwake::measure {

/// Bins without beads of those blocks are filled in.
std::vector<Vector2> first_guess(const std::vector<PhaseBlock>& blocks, const RodGrid& grid, double far_from);

} // namespace rodwake::measure
