#pragma once
// Is a point a minimum, as far as derivatives tell?

#include "evaluator.hpp"

namespace rodwake::fitting {

/// How far from a minimum a point is, of coordinates not held by a bound and directions that are not flat.
struct Stationarity {
    double distance = 0.0; ///< norm of the gradient of objective/2, each entry times its standard error
    double newton = 0.0;   ///< largest relative change of a coordinate by a full Gauss-Newton step
};
Stationarity stationarity(const Evaluator& evaluator, const Point& point);

/// Stationarity::newton below which a point is stationary whatever the distance: data fitted to rounding
/// errors have standard errors of their size.
constexpr double tiny_change = 1e-10;

/// Coordinates on a bound with the objective falling outward.
std::vector<bool> held_by_bounds(const SearchSpace& space, const Eigen::VectorXd& u,
                                 const Eigen::VectorXd& gradient);

} // namespace rodwake::fitting
