#pragma once
// Values with errors and intervals.

#include "curvature.hpp"

namespace rodwake::fitting {

/// Errors in coordinates of the search, what they are multiplied by, and how many make the 95 % interval.
struct Errors {
    const SearchSpace& space;
    const Curvature& curvature;
    double factor, quantile;
};

/// Of 95 %: normal, or Student's t.
double quantile95(bool normal, long dof);

std::vector<Estimate> estimates_of(const Problem& problem, const Fit& fit, const Errors& errors);

} // namespace rodwake::fitting
