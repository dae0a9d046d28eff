#include "laplace.hpp"

#include "rodwake/core/error.hpp"

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

/// int_0^1 (1 - u) exp(-q u) du
double falling(double q) { return q > 0.0 ? -std::expm1(-q) / q - rising(q) : 0.5; }

double slope_of_last_half(std::span<const double> t, std::span<const double> f) {
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
    return xy / xx;
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
    return {t, f, std::max(0.0, slope_of_last_half(t, f))};
}

double laplace(const Sampled& function, double s) {
    if (!(std::isfinite(s) && s > 0.0))
        throw InputError(
            fmt::format("measure: a Laplace transform at s = {:g}: must be finite and positive", s));
    double sum = 0.0, t = 0.0, f = 0.0;
    for (std::size_t i = 0; i < function.t.size(); ++i) {
        const double width = function.t[i] - t;
        sum += width * std::exp(-s * t) * (f * falling(s * width) + function.f[i] * rising(s * width));
        t = function.t[i];
        f = function.f[i];
    }
    return sum + std::exp(-s * t) * (f + function.tail_slope / s) / s;
}

} // namespace rodwake::measure
