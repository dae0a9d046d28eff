#pragma once
// Stronge's law by brute force, sharing nothing with models/granular: the slip angle and the logarithm of the
// slip speed are integrated in extended precision by Gragg-Bulirsch-Stoer, events by bisection of the step.

#include "impact_cases.hpp"

namespace rodwake::granular::oracle {

/// P to about 1e-16 of its norm; slow (milliseconds).
Eigen::Vector3d impulse(const ImpactCase& c);

/// |P - wanted|/|wanted|.
double relative_error(const Eigen::Vector3d& impulse, const Eigen::Vector3d& wanted);

} // namespace rodwake::granular::oracle
