#pragma once

#include "rodwake/core/rng.hpp"

#include <cmath>
#include <numbers>

namespace rodwake {

/// Standard normal deviate (Box and Muller).
inline double normal(RandomStream& random) {
    const double radius = std::sqrt(-2.0 * std::log(random.uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * random.uniform());
}

} // namespace rodwake
