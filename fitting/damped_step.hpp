#pragma once
// One step of Levenberg-Marquardt within bounds.

#include "evaluator.hpp"

namespace rodwake::fitting {

struct DampedStep {
    Eigen::VectorXd step;
    double predicted = 0.0; ///< by how much the linear model lowers |b|^2
};

/// Minimises |A step + b|^2 + lambda |weights step|^2 with u + step within the bounds: coordinates held by a
/// bound stay, those that would pass one are put on it and the others are solved again.
DampedStep damped_step(const Weighted& model, const SearchSpace& space, const Eigen::VectorXd& u,
                       const Eigen::VectorXd& weights, double lambda);

} // namespace rodwake::fitting
