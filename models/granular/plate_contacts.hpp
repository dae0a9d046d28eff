#pragma once
// Beads and rods against floor and lid.

#include "bodies.hpp"
#include "kernels.hpp"
#include "plate_motion.hpp"

namespace rodwake::granular {

/// What plates did to some bodies during one step.
struct PlateTally {
    double floor_impulse = 0.0, lid_impulse = 0.0; ///< upward momentum given, N s
    std::int64_t impulses = 0;
    double max_overlap = 0.0;    ///< in radii, rods only
    double deepest_flight = 0.0; ///< how far a bead flew into a plate before it was put back, in radii
    std::size_t deepest = 0;     ///< number of the bead or rod that was deepest
};

struct PlateStep {
    PlatePath floor;
    double gap, time_step, gravity;
};

/// Puts a bead that flew through a plate back to where and when it touched it, bounces it there, and lets it
/// fly for the rest of the step; again if it comes back within the step. A bead whose hops are shorter than a
/// twentieth of a step comes to rest on the plate. Velocities it had on the way are added to `velocities`.
void bounce_bead(Bodies& bodies, std::size_t bead, const PlateStep& step, const Surface& surface,
                 Range& velocities, PlateTally& tally);

/// One impulse at the deepest contact of the rod with each plate, if it overlaps and approaches.
void bounce_rod(MovingRod& rod, const PlateStep& step, const Surface& surface, PlateTally& tally);

} // namespace rodwake::granular
