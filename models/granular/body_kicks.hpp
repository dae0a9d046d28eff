#pragma once
// Kicks by a body force.

#include "bodies.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/granular/body_force.hpp"

namespace rodwake::granular {

/// Beads get what the force of this time gives them over the duration, where they are. Each on its own: the
/// number of threads changes no bit.
void kick(Bodies& bodies, const BodyForce& force, const PeriodicBox& box, double time, double duration,
          Team& team);

} // namespace rodwake::granular
