#include "laplace.hpp"

#include "rodwake/core/error.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

/// int_0^1 u exp(-q u) du = (1 - (1 + q) exp(-q))/q^2, by its series where that cancels.
double rising(double q) {
    if (q > 0.5)
        return (1.0 - (1.0 + q) * std::exp(-q)) / (q * q);
    double sum = 0.0, power = 1.0;
    for (int n = 0; n < 16; ++n) { // next term: 0.5^16/(16! 18) < 1e-19
        sum += power / (n + 2.0);
        power *= -q / (n + 1.0);
    }
    return sum;
}

} // namespace

Sampled sampled(std::span<const double> t, std::span<const double> f) {
    if (t.size() != f.size() || t.size() < 2)
        throw InputError(
            fmt::format("measure: a Laplace transform of {} times and {} values: needs 2 or more, as "
                        "many values as times",
                        t.size(), f.size()));
    for (std::size_t i = 0; i < t.size(); ++i)
        if (!(std::isfinite(t[i]) && std::isfinite(f[i]) && t[i] > (i > 0 ? t[i - 1] : 0.0)))
            throw InputError(
                fmt::format("measure: a Laplace transform of the point ({:g}, {:g}): times must grow "
                            "from above 0, values be finite",
                            t[i], f[i]));

    // Least squares from half the last time on, of two points at least.
    const auto half = std::ranges::lower_bound(t, t.back() / 2.0);
    const auto first = std::min<std::ptrdiff_t>(half - t.begin(), std::ssize(t) - 2);
    const auto x = t.subspan(first), y = f.subspan(first);
    double middle_x = 0.0, middle_y = 0.0, xx = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        middle_x += x[i] / static_cast<double>(x.size());
        middle_y += y[i] / static_cast<double>(x.size());
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - middle_x) * (x[i] - middle_x);
        xy += (x[i] - middle_x) * (y[i] - middle_y);
    }
    return {t, f, std::max(0.0, xy / xx)};
}

double laplace(const Sampled& function, double s) {
    if (!(std::isfinite(s) && s > 0.0))
        throw InputError(
            fmt::format("measure: a Laplace transform at s = {:g}: must be finite and positive", s));
    double sum = 0.0, t = 0.0, f = 0.0;
    for (std::size_t i = 0; i < function.t.size(); ++i) {
        const double width = function.t[i] - t, q = s * width;
        const double falling =
            q > 0.0 ? -std::expm1(-q) / q - rising(q) : 0.5; // int_0^1 (1 - u) exp(-q u) du
        sum += width * std::exp(-s * t) * (f * falling + function.f[i] * rising(q));
        t = function.t[i];
        f = function.f[i];
    }
    return sum + std::exp(-s * t) * (f + function.tail_slope / s) / s;
}

namespace {

using Row = std::vector<double>;
using Gauss = boost::math::quadrature::gauss<double, 10>;

Row logarithms(std::span<const double> values) {
    Row logs;
    for (const double v : values) {
        if (!(v > 0.0))
            throw InputError(
                fmt::format("measure: a smooth Laplace transform of the value {:g}: must be positive", v));
        logs.push_back(std::log(v));
    }
    return logs;
}

/// Slopes at the points, of the parabola through each and its neighbours.
Row slopes(const Row& x, const Row& y) {
    const std::size_t n = x.size();
    Row h(n - 1), chord(n - 1), slope(n);
    for (std::size_t i = 0; i + 1 < n; ++i) {
        h[i] = x[i + 1] - x[i];
        chord[i] = (y[i + 1] - y[i]) / h[i];
    }
    slope.front() = chord.front();
    slope.back() = chord.back();
    for (std::size_t i = 1; i + 1 < n; ++i)
        slope[i] = (h[i] * chord[i - 1] + h[i - 1] * chord[i]) / (h[i - 1] + h[i]);
    if (n > 2) {
        slope.front() += (chord[0] - chord[1]) * h[0] / (h[0] + h[1]);
        slope.back() += (chord[n - 2] - chord[n - 3]) * h[n - 2] / (h[n - 3] + h[n - 2]);
    }
    return slope;
}

} // namespace

SmoothSampled smooth_sampled(std::span<const double> t, std::span<const double> f, Between between) {
    SmoothSampled smooth;
    smooth.tail_slope = sampled(t, f).tail_slope;
    const Row x = logarithms(t), y = logarithms(f), slope = slopes(x, y);
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
        const double h = x[i + 1] - x[i], chord = (y[i + 1] - y[i]) / h;
        const bool cubic = between == Between::cubics;
        const double slope0 = cubic ? slope[i] : chord, slope1 = cubic ? slope[i + 1] : chord;
        for (std::size_t k = 0; k < Gauss::abscissa().size(); ++k)
            for (const double side : {-1.0, 1.0}) {
                const double u = 0.5 * (1.0 + side * Gauss::abscissa()[k]), v = 1.0 - u,
                             time = std::exp(x[i] + h * u);
                const double log_f = v * v * (1.0 + 2.0 * u) * y[i] + u * u * (1.0 + 2.0 * v) * y[i + 1] +
                                     h * u * v * (v * slope0 - u * slope1);
                smooth.node.push_back(time);
                smooth.weight.push_back(0.5 * h * Gauss::weights()[k] * time * std::exp(log_f)); // dt = t dx
            }
    }
    smooth.first_time = t.front();
    smooth.first = f.front();
    smooth.start_exponent = std::clamp(slope.front(), 0.0, 2.0);
    smooth.last_time = t.back();
    smooth.last = f.back();
    return smooth;
}

double laplace(const SmoothSampled& f, double s) {
    if (!(std::isfinite(s) && s > 0.0))
        throw InputError(
            fmt::format("measure: a Laplace transform at s = {:g}: must be finite and positive", s));
    // int_0^1 u^p exp(-q u) du = exp(-q) sum_n q^n / ((p + 1) ... (p + 1 + n)); all terms are positive.
    const double p = f.start_exponent, q = s * f.first_time;
    double term = 1.0 / (p + 1.0), start = term;
    for (int n = 1; term > 1e-17 * start; ++n)
        start += term *= q / (p + 1.0 + n);
    double sum = f.first * f.first_time * (std::exp(-q) * start);
    for (std::size_t k = 0; k < f.node.size(); ++k)
        sum += f.weight[k] * std::exp(-s * f.node[k]);
    return sum + std::exp(-s * f.last_time) * (f.last + f.tail_slope / s) / s;
}

} // namespace rodwake::measure
