#pragma once
// Tensor products of uniform quintic B-splines on a square: four times continuously differentiable, so that
// third derivatives, which the Jacobian of rods needs, are continuous.

#include "periodic_jet.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace rodwake::elastic {

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

} // namespace rodwake::elastic
