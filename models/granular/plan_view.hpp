#pragma once
// Plan view of the box: rods lying flat are rows of discs on a periodic plane.

#include "rodwake/granular/problem.hpp"

#include <vector>

namespace rodwake::granular {

struct Disc {
    double x, y, radius; ///< m
    double height = 0.0; ///< of the centre above the middle of the gap, m; no part of the plan view
};

/// Sphere centres of a rod as it starts, from the thick to the thin end.
std::vector<Disc> rod_discs(const RodSpec& rod, const Clump& clump);

/// Largest depth by which discs of the two rows overlap, m; negative: the gap between them.
double overlap(const std::vector<Disc>& first, const std::vector<Disc>& second, const PeriodicBox& box);

} // namespace rodwake::granular
