#pragma once
// exp(i G_k.r) for the three wave vectors of a triple with G_1 = G_0 + G_2: two exponentials and a product.

#include "rodwake/measure/bragg.hpp"

#include <array>
#include <cmath>
#include <complex>

namespace rodwake::measure {

using PhaseFactors = std::array<std::complex<double>, 3>;

inline std::complex<double> turn_by(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Spelled out: the library's product looks for infinities.
inline std::complex<double> times(const std::complex<double>& a, const std::complex<double>& b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

inline PhaseFactors plane_waves(const std::array<Vector2, 3>& G, double x, double y) {
    const auto first = turn_by(G[0].x * x + G[0].y * y), last = turn_by(G[2].x * x + G[2].y * y);
    return {first, times(first, last), last};
}

/// Components along axes turned by the angle.
inline Vector2 seen_along(const Vector2& v, double cosine, double sine) {
    return {cosine * v.x + sine * v.y, -sine * v.x + cosine * v.y};
}

inline std::array<Vector2, 3> seen_along(const std::array<Vector2, 3>& G, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {seen_along(G[0], c, s), seen_along(G[1], c, s), seen_along(G[2], c, s)};
}

} // namespace rodwake::measure
