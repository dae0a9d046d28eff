#pragma once
// Random points of the plane and media, where the closed form is hard.

#include "oracle.hpp"

#include "rodwake/core/rng.hpp"

namespace rodwake::oracle {

/// How the direction of a point is drawn.
enum class Angle { uniform, axes, near_wake, near_front, large_exponent };
inline constexpr int angles = 5;

/// How eta is drawn: over twelve decades, below zero, zero.
enum class Stiffness { decades, negative, zero };
inline constexpr int stiffnesses = 3;

/// r/xi log-uniform in [1e-12, 1e8], xi in [1e-6, 1e6].
Point random_point(RandomStream& random, Angle angle, Stiffness stiffness);

/// One of all kinds, by its number.
Point random_point(RandomStream& random, int number);

} // namespace rodwake::oracle
