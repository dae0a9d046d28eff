#include "bessel.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace rodwake::elastic {

namespace {

#include "bessel_tail.inc"

constexpr int series_terms = 8; // next term at z = 1/2: (1/16)^8/(8!)^2 = 1e-19

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

Pair horner(const std::array<double, series_terms>& c, Pair t) {
    Pair sum = t * c[series_terms - 1] + c[series_terms - 2];
    for (int k = series_terms - 3; k >= 0; --k)
        sum = sum * t + c[k];
    return sum;
}

/// Piece of the fits that holds t = 1/z < 2, from the exponent and the first bit of the mantissa: no branch.
const TailPiece& piece(double t) {
    constexpr int half_octave = 51,
                  first = static_cast<int>(std::bit_cast<std::uint64_t>(0x1p-4) >> half_octave);
    const int index = static_cast<int>(std::bit_cast<std::uint64_t>(t) >> half_octave) - first + 1;
    return tail[index > 0 ? index : 0];
}

/// Degree 13 in seven chains of two: a third of Horner's latency.
Pair polynomial(const TailPiece& at, double u) {
    const Pair* c = at.power;
    const double u2 = u * u, u4 = u2 * u2;
    const auto chain = [&](int k) { return c[k] + u * c[k + 1]; };
    const Pair low = chain(0) + u2 * chain(2), middle = chain(4) + u2 * chain(6),
               high = chain(8) + u2 * chain(10);
    return low + u4 * (middle + u4 * (high + u4 * chain(12)));
}

} // namespace

CoreBessel core_bessel(Pair z, Pair log_half) {
    const Pair t = 0.25 * z * z, log_term = log_half + std::numbers::egamma;
    return {horner(series.k0, t) - log_term * horner(series.i0, t),
            0.5 * z * (log_term * horner(series.i1, t) - 0.5 * horner(series.k1, t))};
}

Bessel plain_bessel(double z) {
    const double log_half = std::log(0.5 * z);
    const CoreBessel core = core_bessel(Pair{z, z}, Pair{log_half, log_half});
    const double inverse = 1.0 / z, k0 = core.k0[0], k1 = core.kappa1[0] + inverse, d1 = k1 - k0;
    return {k0, k1, d1, k1 * inverse - 2.0 * d1};
}

Bessel scaled_bessel(double t, double root) {
    const TailPiece& at = piece(t);
    const Pair sum = polynomial(at, at.slope * t + at.offset);
    const double d1 = 0.5 * t * root * sum[0], d2 = 0.75 * t * t * root * sum[1];
    const double k1 = root * (sum[0] + 0.75 * t * sum[1]);
    return {k1 - d1, k1, d1, d2};
}

} // namespace rodwake::elastic
