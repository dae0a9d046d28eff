#pragma once
// Neighbours in the periodic plane by cells.

#include "bodies.hpp"
#include "kernels.hpp"
#include "rodwake/core/parallel.hpp"

namespace rodwake::granular {

/// All pairs of spheres nearer in the plane than the sum of their radii plus `skin`, nearest images, ordered
/// (first, second); pairs of the same rod are left out.
void near_pairs(const Bodies& bodies, const PeriodicBox& box, double skin, Team& team, PairList& list);

} // namespace rodwake::granular
