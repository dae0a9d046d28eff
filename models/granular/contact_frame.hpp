#pragma once
// Impulses in the laboratory frame.

#include "rodwake/granular/impact.hpp"

namespace rodwake::granular {

/// The impulse on body 1 of Stronge's law about `normal` (unit, from body 2 to body 1); everything in world
/// axes.
Eigen::Vector3d impulse_along(const Eigen::Vector3d& normal, const Eigen::Matrix3d& inverse_mass,
                              const Eigen::Vector3d& relative_velocity, const Surface& surface);

} // namespace rodwake::granular
