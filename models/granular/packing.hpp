#pragma once
// Moves beads that overlap apart until none does: between two plates, beside rods that stay, periodic in x
// and y.

#include "plan_view.hpp"

#include "rodwake/core/rng.hpp"

#include <vector>

namespace rodwake::granular {

/// Where beads may be. z = 0 is the middle of the gap; rods lie there, but for a little (Disc::height).
struct Room {
    PeriodicBox box;        ///< m
    double radius;          ///< of the beads, m
    double height;          ///< bead centres keep to |z| <= height, m
    std::vector<Disc> rods; ///< spheres of all rods
};

struct Places {
    std::vector<double> x, y, z; ///< m

    std::size_t size() const { return x.size(); }
};

/// Beads with less than this share of free distance, of two radii, count as overlapping.
inline constexpr double separation = 1e-6;

/// Moves overlapping beads, in turn and always in the same order, and shakes them if that does not end.
/// Returns the largest remaining overlap, m: 0 if nothing overlaps, more if no packing was found.
double push_apart(Places& places, const Room& room, RandomStream random);

} // namespace rodwake::granular
