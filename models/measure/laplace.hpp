#pragma once
// Laplace transform of a function known at some times, for mean-square displacements.

#include <span>

namespace rodwake::measure {

/// A function through (0, 0) and (t_i, f_i), t_i growing, straight between them. Beyond the last time it goes
/// on along `tail_slope`, the slope of the straight line (least squares) through the points from half the
/// last time on, or 0 where that slope is negative: a bound bead's plateau, a free one's diffusion.
struct Sampled {
    std::span<const double> t, f;
    double tail_slope = 0.0;
};

/// Throws InputError for fewer than 2 points, times that do not grow from above 0, or values that are not
/// finite.
Sampled sampled(std::span<const double> t, std::span<const double> f);

/// int_0^inf f(t) exp(-s t) dt of that function, exact but for round-off. Throws InputError unless s > 0.
double laplace(const Sampled& function, double s);

} // namespace rodwake::measure
