#pragma once
// Levenberg-Marquardt within bounds, from a point already found to a stationary one.

#include "evaluator.hpp"
#include "search_end.hpp"

namespace rodwake::fitting {

/// Never ends at a worse objective than that of `start`. Needs the Jacobian.
SearchEnd polish(Evaluator& evaluator, const Eigen::VectorXd& start, long max_iterations = 1000);

} // namespace rodwake::fitting
