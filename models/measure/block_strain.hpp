#pragma once
// In a window the crystal's lattice is known no better than the far field of a block of time tells it, and
// that is strained by the wake itself, otherwise in each block, as the rod is elsewhere. So each block has a
// linear function of its own in its displacements,
//
//   u_b(r) = U(r) + c_b + A_b r,
//
// which is found together with U, in turns, from what the blocks have in common. What remains unknown is one
// linear function for all: U is given such that it has none where it is far.

#include "phase_cell.hpp"

namespace rodwake::measure {

/// Takes c_b + A_b r off `sums`, which those of the blocks refer to. `u`: a first guess of U in each bin,
/// then U. Nearer to the rod than `from` nothing is fitted; `far_from`: where U has no linear function.
void take_off_strain(const std::vector<PhaseBlock>& blocks, std::vector<std::vector<double>>& sums,
                     const RodGrid& grid, double from, double far_from, std::vector<Vector2>& u);

} // namespace rodwake::measure
