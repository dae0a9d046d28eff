#pragma once
// Which integrator suits a problem, for method = "auto".

#include "rodwake/rods/simulate.hpp"

namespace rodwake::rods {

/// Rods are not stiff until a heading relaxes much faster than a rod walks past its neighbour. With k the
/// largest |d theta_a'/d theta_b| at the start and r the smallest separation, k r (v0 = 1) is that ratio:
/// above 30 BDF, below explicit Runge-Kutta. Measured at both ends in docs/validation.md (side by side, 5
/// apart: 0.5 at kappa = 100, 46 at kappa = 1e4).
integrate::Method suitable_method(const RodProblem& problem);

/// k r of the above; 0 for rods that do not interact.
double stiffness(const RodProblem& problem);

} // namespace rodwake::rods
