#pragma once
// Numbers that say where beads are: what is near in the plane is near in memory.

#include "packing.hpp"

namespace rodwake::granular {

/// The same places in the order of tiles, square or nearly so, of about 64 beads, tiles along a Z curve
/// (Morton 1966), so that any 2048 successive beads fill one or two compact patches. Beads of a tile keep
/// their order; as few as one tile's change nothing. Impulses are given in the order of numbers
/// (pair_contacts.hpp), so numbers belong to the start.
Places numbered_by_place(const Places& places, const PeriodicBox& box);

} // namespace rodwake::granular
