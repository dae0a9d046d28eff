#include "bessel.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::elastic {

namespace {

#include "bessel_tail.inc"

constexpr int series_terms = 10; // next term at z = 1: (1/4)^10/(10!)^2 = 7e-20

/// Coefficients in t = z^2/4 of I0, of K0's regular part, of 2 I1/z and of K1's regular part
/// (DLMF 10.25.2, 10.31.1-2).
struct Series {
    std::array<double, series_terms> i0, k0, i1, k1;
};

constexpr Series make_series() {
    Series s{};
    double factorial = 1.0, harmonic = 0.0;
    for (int k = 0; k < series_terms; ++k) {
        if (k > 0) {
            factorial *= k;
            harmonic += 1.0 / k;
        }
        const double next = factorial * (k + 1);
        s.i0[k] = 1.0 / (factorial * factorial);
        s.k0[k] = harmonic / (factorial * factorial);
        s.i1[k] = 1.0 / (factorial * next);
        s.k1[k] = (2.0 * harmonic + 1.0 / (k + 1)) / (factorial * next);
    }
    return s;
}

constexpr Series series = make_series();

double horner(const std::array<double, series_terms>& c, double t) {
    double sum = c[series_terms - 1];
    for (int k = series_terms - 2; k >= 0; --k)
        sum = sum * t + c[k];
    return sum;
}

/// Degree 17 in six interleaved chains of u^6: a third of Horner's latency.
double polynomial(const double (&c)[18], double u) {
    const double u2 = u * u, u3 = u2 * u, u6 = u3 * u3;
    const auto chain = [&](int k) { return (c[k + 12] * u6 + c[k + 6]) * u6 + c[k]; };
    return (chain(0) + u * chain(1)) + (u2 * (chain(2) + u * chain(3)) + u2 * u2 * (chain(4) + u * chain(5)));
}

/// Piece of the tail fits that holds t = 1/z <= 1, without a branch, and the place of t in it, in [-1, 1].
struct Piece {
    int index;
    double u;
};
Piece piece(double t) {
    constexpr double slope[] = {4.0, 8.0, 16.0, 16.0}, offset[] = {-3.0, -3.0, -3.0, -1.0};
    const int index = (t <= 0.5) + (t <= 0.25) + (t <= 0.125);
    return {index, slope[index] * t + offset[index]};
}

ScaledBessel scaled_from_core(double z) {
    const CoreBessel core = core_bessel(z);
    const double e = std::exp(z), k0 = e * core.k0, k1 = e * (core.kappa1 + 1.0 / z), d1 = k1 - k0;
    return {k0, k1, d1, k1 / z - 2.0 * d1};
}

} // namespace

CoreBessel core_bessel(double z) {
    const double t = 0.25 * z * z, log_term = std::log(0.5 * z) + std::numbers::egamma;
    return {horner(series.k0, t) - log_term * horner(series.i0, t),
            0.5 * z * (log_term * horner(series.i1, t) - 0.5 * horner(series.k1, t))};
}

ScaledBessel scaled_bessel(double z) {
    if (z < 1.0)
        return scaled_from_core(z);
    const double t = 1.0 / z;
    const Piece at = piece(t);
    const double scale = 0.5 * t * std::sqrt(0.5 * std::numbers::pi * t);
    const double d1 = scale * polynomial(tail1[at.index], at.u);
    const double d2 = 1.5 * t * scale * polynomial(tail2[at.index], at.u);
    const double k1 = z * (d2 + 2.0 * d1);
    return {k1 - d1, k1, d1, d2};
}

} // namespace rodwake::elastic
