#pragma once
// Beads and rods against the plates.

#include "bodies.hpp"
#include "kernels.hpp"
#include "plates.hpp"
#include "rod_motion.hpp"

#include <cstdint>
#include <functional>
#include <span>

namespace rodwake::granular {

/// Puts beads that flew through a plate back to where and when they touched it, bounces them there, and lets
/// them fly for the rest of the step; again if they come back within the step. A bead whose hops are shorter
/// than a twentieth of a step comes to rest on the plate. Velocities on the way are added to `velocities`.
void bounce_beads(Bodies& bodies, std::span<const std::uint32_t> beads, const PlateStep& step,
                  const Surface& surface, BodyRange& velocities, PlateTally& tally);

/// Moves rods through one step. Between impulses they fly freely (rod_motion.hpp); where one of a rod's
/// spheres touches a plate it gets an impulse at that instant, as often as it touches within the step. A
/// contact whose hop would be shorter than an eighth of a step rests on the plate: it gets an impulse without
/// rebound that often, which tends to a lasting contact with Coulomb friction as the step goes to zero.
/// Adds what each rod got from the plates to `momentum`, N s.
using RodMoved = std::function<void(const MovingRod&)>; ///< called after each change of a velocity
void fly_rods(std::span<MovingRod> rods, const PlateStep& step, const Surface& surface, PlateTally& tally,
              std::span<Eigen::Vector3d> momentum, const RodMoved& moved);

} // namespace rodwake::granular
