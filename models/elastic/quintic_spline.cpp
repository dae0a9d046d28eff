#include "quintic_spline.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::elastic {

namespace {

constexpr std::size_t degree = QuinticKnots::degree, pieces = degree + 1;
using Weights = std::array<double, pieces>;

/// B_p(u + j) for j = 0 ... p, where B_p is the B-spline of degree p with knots 0, 1, ..., p + 1:
/// p B_p(t) = t B_{p-1}(t) + (p + 1 - t) B_{p-1}(t - 1) (de Boor, A Practical Guide to Splines, ch. IX).
std::array<Weights, pieces> all_degrees(double u) {
    std::array<Weights, pieces> b{};
    b[0][0] = 1.0;
    for (std::size_t p = 1; p <= degree; ++p)
        for (std::size_t j = 0; j <= p; ++j) {
            const double t = u + static_cast<double>(j), top = static_cast<double>(p) + 1.0;
            const double here = j < p ? t * b[p - 1][j] : 0.0;
            const double before = j > 0 ? (top - t) * b[p - 1][j - 1] : 0.0;
            b[p][j] = (here + before) / static_cast<double>(p);
        }
    return b;
}

/// B_p' (t) = B_{p-1}(t) - B_{p-1}(t - 1).
Weights difference(const Weights& b) {
    Weights d{};
    for (std::size_t j = 0; j < pieces; ++j)
        d[j] = b[j] - (j > 0 ? b[j - 1] : 0.0);
    return d;
}

} // namespace

QuinticValues values_at(const QuinticKnots& knots, double x) {
    const double s = (x - knots.first) / knots.width;
    const double interval = std::clamp(std::floor(s), 0.0, static_cast<double>(knots.intervals - 1));
    const auto b = all_degrees(s - interval);
    QuinticValues values;
    values.first = static_cast<std::size_t>(interval);
    double scale = 1.0;
    for (std::size_t k = 0; k < values.by.size(); ++k, scale /= knots.width) {
        Weights d = b[degree - k];
        for (std::size_t times = 0; times < k; ++times)
            d = difference(d);
        for (std::size_t i = 0; i < pieces; ++i) // function first + i began degree - i intervals before
            values.by[k][i] = scale * d[degree - i];
    }
    return values;
}

Jet spline_at(const QuinticKnots& knots, std::span<const double> coefficients, double x, double y) {
    const QuinticValues along = values_at(knots, x), across = values_at(knots, y);
    std::array<std::array<double, 4>, 4> d{}; // [by x][by y]
    for (std::size_t j = 0; j < pieces; ++j) {
        const double* row = coefficients.data() + (across.first + j) * knots.functions() + along.first;
        for (std::size_t k = 0; k < 4; ++k) {
            double sum = 0.0;
            for (std::size_t i = 0; i < pieces; ++i)
                sum += along.by[k][i] * row[i];
            for (std::size_t l = 0; k + l < 4; ++l)
                d[k][l] += across.by[l][j] * sum;
        }
    }
    return {d[0][0], d[1][0], d[0][1], d[2][0], d[1][1], d[0][2], d[3][0], d[2][1], d[1][2], d[0][3]};
}

} // namespace rodwake::elastic
