#pragma once
// Sites of a triangular lattice that closes in the periodic square.

#include "rodwake/granular/start.hpp"

#include <Eigen/Core>

#include <vector>

namespace rodwake::granular {

/// fit.sites points in [0, box)^2, exact to rounding, always in the same order; the first is (0, 0).
std::vector<Eigen::Vector2d> lattice_sites(const LatticeFit& fit, double box);

} // namespace rodwake::granular
