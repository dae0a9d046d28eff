#pragma once
// Neighbours in the periodic plane by cells.

#include "kernels.hpp"
#include "rows.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rodwake::granular {

/// All pairs of spheres nearer in the plane than the sum of their radii plus `skin`, nearest images, ordered
/// (first, second); pairs of the same rod (rod_of, counted from sphere `beads` on) are left out.
void near_pairs(const Rows& position, const std::vector<double>& radius, std::size_t beads,
                const std::vector<std::uint32_t>& rod_of, double box, double skin, PairList& list);

} // namespace rodwake::granular
