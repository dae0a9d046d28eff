#pragma once
// What a report says in sentences.

#include "evaluator.hpp"
#include "rodwake/fitting/report.hpp"

namespace rodwake::fitting {

// What derivatives tell of a point: is it a minimum, and what errors its curvature means.

/// How far from a minimum a point is, of coordinates not held by a bound and directions that are not flat.
struct Stationarity {
    double distance = 0.0; ///< norm of the gradient of objective/2, each entry times its standard error
    double newton = 0.0;   ///< largest relative change of a coordinate by a full Gauss-Newton step
};
Stationarity stationarity(const Evaluator& evaluator, const SearchPoint& point);

/// Stationarity::newton below which a point is stationary whatever the distance: data fitted to rounding
/// errors have standard errors of their size.
constexpr double tiny_change = 1e-10;

/// Coordinates on a bound with the objective falling outward.
std::vector<bool> held_by_bounds(const SearchSpace& space, const Eigen::VectorXd& u,
                                 const Eigen::VectorXd& gradient);

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

Curvature curvature(const SearchSpace& space, const SearchPoint& point, const Eigen::VectorXd& gradient,
                    double rank_tolerance);

/// Multiplier of the errors and rise of the objective that belongs to one standard error.
struct ErrorScale {
    double factor = 1.0, rise = 1.0;
};
ErrorScale error_scale(const Problem& problem, const LossShape& loss, const SearchPoint& point, long dof);

/// Exactly flat and nearly flat directions (relative singular value below 1e-3).
std::vector<FlatDirection> flat_directions(const Problem& problem, const Fit& fit, const SearchSpace& space,
                                           const Curvature& curvature);

/// `rise`: of the objective, that belongs to one standard error. `exact`: a full step would change no digit
/// that counts.
std::vector<std::string> diagnostics_of(const Problem& problem, const Fit& fit, const Report& report,
                                        double rise, bool exact);

/// Whether a start ended in the minimum that the fit reports: as low but for rounding, or as low but for 1e-4
/// and in the same place.
bool at_the_best(const Fit& fit, const Report& report, const StartResult& start);

/// "0.02", or "< 1e-300" where doubles end.
std::string describe_probability(double probability);

} // namespace rodwake::fitting
