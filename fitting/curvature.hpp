#pragma once
// Errors from the curvature at the minimum: what Report is made of.

#include "evaluator.hpp"
#include "rodwake/fitting/report.hpp"

namespace rodwake::fitting {

/// C = (J^T J)^-1 in coordinates of the search, by parts. Coordinates on a bound are left out (zero rows).
struct Curvature {
    std::vector<bool> held;         ///< on a bound with the objective falling outward, or exactly on it
    Eigen::VectorXd standard_error; ///< infinite in flat directions, 0 where held
    Eigen::MatrixXd root;           ///< finite part of C = root root^T
    Eigen::MatrixXd directions; ///< right singular vectors (columns), in u, of unit length in the scaled J
    Eigen::MatrixXd scaled;     ///< the same in columns scaled to unit length: how much each takes part
    Eigen::VectorXd singular_values; ///< relative to the largest, falling
    long rank = 0;
};

Curvature curvature(const SearchSpace& space, const Point& point, const Eigen::VectorXd& gradient,
                    double rank_tolerance);

/// Multiplier of the errors and rise of the objective that belongs to one standard error.
struct ErrorScale {
    double factor = 1.0, rise = 1.0;
};
ErrorScale error_scale(const Problem& problem, const LossShape& loss, const Point& point, long dof);

} // namespace rodwake::fitting
