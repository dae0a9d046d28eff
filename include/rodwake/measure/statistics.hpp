#pragma once
// Means with standard errors, and straight lines through points with errors.

#include "rodwake/core/estimate.hpp"

#include <span>

namespace rodwake::measure {

/// Weighted mean of block values w_b, v_b; the error allows for unequal weights:
///   error^2 = sum w_b^2 (v_b - mean)^2 / (sum w_b)^2 * n/(n - 1),   n blocks of positive weight.
/// Equal weights: the usual s/sqrt(n). Empty weights: all equal. Without any weight: count 0, value 0. The
/// error from fewer than 2 blocks is unknown.
Estimate mean_of_blocks(std::span<const double> values, std::span<const double> weights = {});

/// Correlation of successive values, sum (v_b - m)(v_b+1 - m) / sum (v_b - m)^2, in [-1, 1]; 0 for fewer than
/// 3 values or no scatter.
double successive_correlation(std::span<const double> values);

/// What the standard error of a mean grows by when successive blocks correlate: sqrt((1 + r)/(1 - r)) for r
/// in (0, 0.9], 1 below, that of 0.9 above.
double correlation_factor(double r);

/// y = intercept + slope x by weighted least squares, weights 1/error^2. Errors follow from the given errors;
/// chi2 tells whether those explain the scatter (dof = points - parameters).
struct LineFit {
    Estimate intercept, slope;
    double covariance = 0.0; ///< of intercept and slope
    double chi2 = 0.0;
    long dof = 0;
};

/// Throws InputError for fewer than 2 points, fewer than 2 different x, or errors that are not positive.
LineFit fit_line(std::span<const double> x, std::span<const double> y, std::span<const double> error);

/// The same through the origin; the intercept is 0 with error 0.
LineFit fit_proportional(std::span<const double> x, std::span<const double> y, std::span<const double> error);

/// Probability that chi2 with dof degrees of freedom is at least this large; 1 for dof = 0.
double chi2_probability(double chi2, long dof);

// Which way something is measured, where there are several: what a scene chooses from.

/// Of the displacement field; displacement.hpp says what each does.
enum class DisplacementMethod { phase, lagrangian, density };
/// What a displacement is relative to: its mean over the box, or the beads far from the rods.
enum class Reference { box, far };
/// Whose angles count in psi_6: beads nearer than a cut-off, or Delaunay neighbours.
enum class Neighbours { cutoff, delaunay };

} // namespace rodwake::measure
