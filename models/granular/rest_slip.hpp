#pragma once
// Linear algebra of zero slip: 2x2 systems solved to rounding, and the direction in which slip goes on.

#include "slip_path.hpp"

namespace rodwake::granular {

/// xx yy - xy^2, relative error of a few units in the last place.
double determinant(double xx, double xy, double yy);

/// A^-1 b, each component to a few units in the last place however near A is to singular.
Eigen::Vector2d solve(const Eigen::Matrix2d& a, const Eigen::Vector2d& b);

/// The s with (lambda + mu A) s = q, |s| = 1, lambda > 0: slip along it grows, dr/dp = lambda, and keeps its
/// direction. There is exactly one if |A^-1 q| > mu.
Eigen::Vector2d resumed_direction(const ContactTerms& contact);

} // namespace rodwake::granular
