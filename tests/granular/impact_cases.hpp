#pragma once
// Random impacts: inverse masses of real bodies and others, and starts that are hard on purpose.

#include "rodwake/core/rng.hpp"
#include "rodwake/granular/impact.hpp"

namespace rodwake::granular {

/// K = diag(k_t, k_t, k_n).
ImpactCase sphere_case(RandomStream& random);
/// A rod with its axis, contact arm and velocity in the x-z plane.
ImpactCase planar_case(RandomStream& random);
/// A rod of any attitude, two of them, or one and a sphere: sums of 1/m - [c] I^-1 [c].
ImpactCase rod_case(RandomStream& random);
/// Any symmetric positive definite K with condition number up to `condition`.
ImpactCase general_case(RandomStream& random, double condition);

/// Kinds of hard cases: near the stick boundary, jam (self-locking), tiny mu, huge mu, e = 0, e = 1, nearly
/// singular K, slip opposite to the direction in which it would go on, no slip, v_z tiny, v_t tiny, scales.
inline constexpr int hard_kinds = 12;
ImpactCase hard_case(RandomStream& random, int kind);

} // namespace rodwake::granular
