#pragma once
// Beads against the plates.

#include "bodies.hpp"
#include "kernels.hpp"
#include "plates.hpp"

namespace rodwake::granular {

/// Puts a bead that flew through a plate back to where and when it touched it, bounces it there, and lets it
/// fly for the rest of the step; again if it comes back within the step. A bead whose hops are shorter than a
/// twentieth of a step comes to rest on the plate. Velocities it had on the way are added to `velocities`.
void bounce_bead(Bodies& bodies, std::size_t bead, const PlateStep& step, const Surface& surface,
                 Range& velocities, PlateTally& tally);

} // namespace rodwake::granular
