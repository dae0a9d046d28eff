#pragma once
// Least squares of A m(r; k) to points with errors, where k alone is nonlinear: A follows from k.

#include "rodwake/core/estimate.hpp"
#include "rodwake/core/periodic.hpp"

#include <span>
#include <vector>

namespace rodwake::measure {

struct ShapeFit {
    double k = 0.0, amplitude = 0.0, chi2 = 0.0;
    double error = unknown_error; ///< of k, where chi2 has grown by 1 by its curvature; unknown without one
};

/// m(r; k) at one distance. `box` 0: infinite plane.
using Shape = double (*)(double r, double k, const PeriodicBox& box);
double algebraic_shape(double r, double eta, const PeriodicBox& box);    ///< exp(-eta s), see order.hpp
double exponential_shape(double r, double rate, const PeriodicBox& box); ///< rate = 1/xi

struct Points {
    std::span<const double> r, value, error;
};
double chi2_of_shape(Shape shape, const Points& points, double k, const PeriodicBox& box);
/// The smallest chi2 of k in [low, high], which holds one minimum; the error stays unknown.
ShapeFit refine_shape(Shape shape, const Points& points, double low, double high, const PeriodicBox& box);
/// The same where there may be several, from a scan that is then refined.
ShapeFit fit_shape(Shape shape, const Points& points, double low, double high, const PeriodicBox& box);

} // namespace rodwake::measure
