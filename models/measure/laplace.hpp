#pragma once
// Laplace transform of a function known at some times, for mean-square displacements.

#include <span>
#include <vector>

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

// Laplace transform of a mean-square displacement over a wide range of s. The straight lines of laplace.hpp
// are off where Delta bends within one step of the lags, above all near the first lag, where a ballistic
// Delta ~ t^2 lies far below its chord. Here Delta is smooth in ln Delta against ln t, which is exact for
// every power law.

/// How ln f goes from one ln t_i to the next.
enum class Between {
    cubics,     ///< Hermite cubics, slopes of the parabola through three neighbours: error of order h^4
    power_laws, ///< straight lines: error of order h^2
};

/// A function through (t_i, f_i), both positive. Below t_1 it is f_1 (t/t_1)^start_exponent, with the slope
/// of the first points, kept within 0 and 2: nothing that moves at a finite speed goes faster than t^2.
/// Beyond the last time it goes on straight as `Sampled` does.
struct SmoothSampled {
    std::vector<double> node, weight; ///< of the integral between the first and the last time, f included
    double first_time = 0.0, first = 0.0, start_exponent = 1.0;
    double last_time = 0.0, last = 0.0, tail_slope = 0.0;
};

/// Throws InputError as `sampled` does, and for values that are not positive.
SmoothSampled smooth_sampled(std::span<const double> t, std::span<const double> f, Between between);

/// int_0^inf f(t) exp(-s t) dt of that function. The quadrature, 10 points of Gauss a piece, is exact to
/// 1e-12 while pieces are an octave or shorter and s t_1 <= 2. Throws InputError unless s > 0.
double laplace(const SmoothSampled& function, double s);

} // namespace rodwake::measure
