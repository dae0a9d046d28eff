#pragma once
// The two stages of a search: NLopt (nlopt.h is included by nlopt_search.cpp alone), and Levenberg-Marquardt
// within bounds, from a point already found to a stationary one.

#include "evaluator.hpp"
#include "rodwake/fitting/fit.hpp"
#include "rodwake/fitting/method.hpp"
#include "rodwake/fitting/problem.hpp"

namespace rodwake::fitting {

/// Where a stage ended, and why.
struct SearchResult {
    Eigen::VectorXd u;
    double objective = std::numeric_limits<double>::infinity();
    Termination termination = Termination::failed;
    std::string reason;
};

/// From `start`; global algorithms are followed by slsqp from where they ended. `seed`: of the random
/// searches.
SearchResult nlopt_search(Evaluator& evaluator, const Method& method, const Eigen::VectorXd& start,
                          std::uint32_t seed);

/// One step of Levenberg-Marquardt.
struct DampedStep {
    Eigen::VectorXd step;
    double predicted = 0.0; ///< by how much the linear model lowers |b|^2
};

/// Minimises |A step + b|^2 + lambda |weights step|^2 with u + step within the bounds: coordinates held by a
/// bound stay, those that would pass one are put on it and the others are solved again.
DampedStep damped_step(const Weighted& model, const SearchSpace& space, const Eigen::VectorXd& u,
                       const Eigen::VectorXd& weights, double lambda);

/// Never ends at a worse objective than that of `start`. Needs the Jacobian.
SearchResult levenberg_marquardt(Evaluator& evaluator, const Eigen::VectorXd& start,
                                 long max_iterations = 1000);

/// Throws InputError: values out of range, a global search without bounds, finished starts of another fit.
void check_method(const Problem& problem, const Method& method);

} // namespace rodwake::fitting
