#pragma once
// Smooth fits of scattered values: penalised B-splines (Eilers and Marx, Stat. Sci. 11, 89 (1996)).
//
// The coefficients c of a quintic_spline.hpp f minimise
//
//   sum_i q_i (f(x_i, y_i) - v_i)^2 + lambda |third differences of c along x and along y|^2,
//
// q_i = 1/sigma_i^2 over its mean, so that lambda is a number without unit.
//
// lambda by generalised cross-validation (Craven and Wahba, Numer. Math. 31, 377 (1979)) with errors that are
// correlated from point to point (Altman, J. Am. Stat. Assoc. 85, 749 (1990)): the least of
//
//   [sum_i q_i (f_i - v_i)^2/N] / [1 - tr(H R)/N]^2,
//
// H the matrix that makes fitted of given values, R the correlation of the errors, both in units of sigma.
// The trace is the mean of z.H z over probes z that have the correlation R (Girard, Numer. Math. 56, 1
// (1989)); R = 1 is the ordinary rule, which takes correlated noise for signal.

#include "periodic_jet.hpp"

#include <Eigen/SparseCholesky>

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace rodwake::elastic {

// Tensor products of uniform quintic B-splines on a square: four times continuously differentiable, so that
// third derivatives, which the Jacobian of rods needs, are continuous.

/// The functions along one side: `intervals` of equal width from `first` on, five functions more than those.
struct QuinticKnots {
    static constexpr std::size_t degree = 5;

    double first = 0.0, width = 1.0;
    std::size_t intervals = 1;

    std::size_t functions() const { return intervals + degree; }
    double last() const { return first + width * static_cast<double>(intervals); }
};

/// The six functions that are not 0 at a place, from number `first` on, with derivatives up to the third:
/// by[k][i]. Outside the knots those of the nearest interval, continued as polynomials.
struct QuinticValues {
    std::size_t first = 0;
    std::array<std::array<double, QuinticKnots::degree + 1>, 4> by{};
};
QuinticValues values_at(const QuinticKnots& knots, double x);

/// The spline at (x, y); `coefficients`: [function of y][function of x].
Jet spline_at(const QuinticKnots& knots, std::span<const double> coefficients, double x, double y);

struct SplinePoints {
    std::vector<double> x, y, sigma;
};

class SmoothingSpline {
public:
    SmoothingSpline(const QuinticKnots& knots, const SplinePoints& points);

    /// `probes`: a column each, in units of sigma. Keeps what it finds, and returns it.
    double choose(std::span<const double> values, const Eigen::MatrixXd& probes);
    void set_lambda(double lambda);

    /// Coefficients. Linear in the values.
    std::vector<double> fit(std::span<const double> values) const;
    /// sum (f - v)^2/sigma^2
    double chi2(std::span<const double> values, std::span<const double> coefficients) const;
    /// tr(H R)
    double trace(const Eigen::MatrixXd& probes) const;

private:
    using Matrix = Eigen::SparseMatrix<double>;

    Eigen::VectorXd scaled(std::span<const double> values) const;

    Eigen::VectorXd root_weights_; ///< sqrt(q_i)
    double mean_weight_ = 1.0;     ///< mean of 1/sigma^2
    Matrix design_;                ///< sqrt(q_i) times the functions at point i
    Matrix normal_, penalty_;
    std::unique_ptr<Eigen::SimplicialLLT<Matrix>> factor_; ///< cannot be moved by itself
};

} // namespace rodwake::elastic
