#pragma once
// Pairs of beads and of beads with rod spheres that are near each other in plan view.

#include "packing.hpp"

#include <cstdint>
#include <vector>

namespace rodwake::granular {

/// Of beads by their places in Neighbours::order, and of spheres of rods by their numbers.
struct Near {
    std::uint32_t bead, other; ///< other: a bead, or a rod's sphere
};

struct Neighbours {
    std::vector<std::uint32_t> order; ///< the beads, cell by cell: neighbours are near each other here too
    std::vector<Near> beads;          ///< each pair once
    std::vector<Near> rods;
};

/// All pairs whose surfaces are less than `skin` apart in plan view, in an order that depends on the places
/// only.
Neighbours neighbours(const Places& places, const Room& room, double skin);

} // namespace rodwake::granular
