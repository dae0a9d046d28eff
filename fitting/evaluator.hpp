#pragma once
// Objective of one search: the loss of each residual; guards the user's function, counts, keeps the best
// point seen.

#include "rodwake/fitting/method.hpp"
#include "search_space.hpp"

#include <new>

namespace rodwake::fitting {

/// Loss functions of the squared residual s = r^2; the objective is sum rho(s).
struct LossShape {
    Loss loss = Loss::squares;
    double width = 1.5;
};

/// rho and its first two derivatives in s. rho'(0) = 1.
struct LossValue {
    double rho = 0.0, first = 1.0, second = 0.0;

    /// Second derivative of rho/2 in r: what a residual adds to the curvature.
    double curvature(double s) const { return first + 2.0 * s * second; }
};

LossValue loss_of(const LossShape& shape, double s);

/// A point of the search. Not finite: the residuals threw or were not finite there; nothing else is set.
struct SearchPoint {
    Eigen::VectorXd u;
    Eigen::VectorXd r;
    Eigen::MatrixXd jacobian; ///< d r/d u; empty if not asked for
    double objective = std::numeric_limits<double>::infinity();

    bool finite() const { return objective < std::numeric_limits<double>::infinity(); }
};

/// Gauss-Newton form of a loss: objective = |b|^2 + const to first order, curvature A^T A.
struct Weighted {
    Eigen::MatrixXd a;     ///< rows of the Jacobian times the root of their curvature
    Eigen::VectorXd b;     ///< A^T b = gradient of objective/2
    Eigen::VectorXd roots; ///< what the rows were multiplied by
};

class Evaluator {
public:
    Evaluator(const Problem& problem, const SearchSpace& space, LossShape loss,
              std::function<bool()> stop = {});

    SearchPoint operator()(const Eigen::VectorXd& u, bool with_jacobian);
    Weighted weighted(const SearchPoint& point) const;
    /// Of the objective, in u.
    Eigen::VectorXd gradient(const SearchPoint& point) const;

    const SearchSpace& space() const { return space_; }
    long evaluations() const { return evaluations_; }
    bool stopped() const { return stopped_; }
    /// Out of memory is no property of a point, as other exceptions are: the search stops, and whoever ran it
    /// calls this, for none may pass through NLopt.
    void require_memory() const {
        if (out_of_memory_)
            throw std::bad_alloc();
    }
    bool found() const { return best_ < std::numeric_limits<double>::infinity(); }
    double best() const { return best_; }
    const Eigen::VectorXd& best_u() const { return best_u_; }
    /// Why the last point that was not finite was none.
    const std::string& trouble() const { return trouble_; }

private:
    /// Sets point.r; false, with trouble_ set, where the model throws or a number is not finite.
    bool guarded(std::span<const double> values, SearchPoint& point, Eigen::MatrixXd* in_values);

    const Problem& problem_;
    const SearchSpace& space_;
    LossShape loss_;
    std::function<bool()> stop_;
    Eigen::MatrixXd in_values_;
    long evaluations_ = 0;
    bool stopped_ = false, out_of_memory_ = false;
    double best_ = std::numeric_limits<double>::infinity();
    Eigen::VectorXd best_u_;
    std::string trouble_;
};

} // namespace rodwake::fitting
