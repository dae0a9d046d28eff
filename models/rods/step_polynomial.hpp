#pragma once
// A pair's solution over a step as polynomials, and what Chebyshev points tell of functions along it.
// docs/physics.md, section 7.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace rodwake::rods {

inline constexpr int degree = 6, nodes = degree + 1; ///< of expansions over a step

/// Chebyshev points of the second kind, -1 to 1.
constexpr double half_root3 = 0.5 * std::numbers::sqrt3;
constexpr std::array<double, nodes> node_at{-1.0, -half_root3, -0.5, 0.0, 0.5, half_root3, 1.0};

/// Values at the nodes: the mean coefficient of their expansion, and the sum of the others' sizes.
struct Spread {
    double mean, beyond;
};

inline Spread spread_of(const double* f) {
    const double s0 = f[6] + f[0], s1 = f[5] + f[1], s2 = f[4] + f[2], f3 = f[3];
    const double d0 = f[6] - f[0], d1 = f[5] - f[1], d2 = f[4] - f[2];
    const double even = 0.5 * s0 + s1 + s2 + f3;
    const double c2 = 0.5 * s0 + 0.5 * s1 - 0.5 * s2 - f3, c4 = 0.5 * s0 - 0.5 * s1 - 0.5 * s2 + f3,
                 c6 = 0.5 * (0.5 * s0 - s1 + s2 - f3);
    const double c1 = 0.5 * d0 + half_root3 * d1 + 0.5 * d2, c3 = 0.5 * d0 - d2,
                 c5 = 0.5 * d0 - half_root3 * d1 + 0.5 * d2;
    return {even / degree,
            (std::abs(c1) + std::abs(c2) + std::abs(c3) + std::abs(c4) + std::abs(c5) + std::abs(c6)) *
                (2.0 / degree)};
}

/// The quintic through values, rates and second derivatives at both ends of a step, in v from -1 to 1.
struct Quintic {
    std::array<double, 6> c;

    /// Rates and second derivatives by v.
    static Quintic through(const std::array<double, 3>& low, const std::array<double, 3>& high) {
        const auto mean = [&](std::size_t k) { return 0.5 * (high[k] + low[k]); };
        const auto half = [&](std::size_t k) { return 0.5 * (high[k] - low[k]); };
        const double a4 = (mean(2) - half(1)) / 8.0, a2 = 0.5 * (half(1) - 4.0 * a4);
        const double slope = mean(1) - half(0), a5 = (half(2) - 3.0 * slope) / 8.0,
                     a3 = 0.5 * slope - 2.0 * a5;
        return {{mean(0) - a2 - a4, half(0) - a3 - a5, a2, a3, a4, a5}};
    }
    double at(double v) const { return c[0] + v * (c[1] + v * (c[2] + v * (c[3] + v * (c[4] + v * c[5])))); }
    double slope(double v) const {
        return c[1] + v * (2.0 * c[2] + v * (3.0 * c[3] + v * (4.0 * c[4] + v * 5.0 * c[5])));
    }
    /// In the variable of the half below or above the middle.
    Quintic half(double middle) const {
        Quintic q{};
        for (std::size_t k = 6; k-- > 0;) { // Horner's rule with v = middle + u/2
            for (std::size_t j = 5; j > 0; --j)
                q.c[j] = middle * q.c[j] + 0.5 * q.c[j - 1];
            q.c[0] = middle * q.c[0] + c[k];
        }
        return q;
    }
    /// |p(v) - p(0)| for |v| <= reach, complex too.
    double excursion(double reach) const {
        double sum = 0.0;
        for (std::size_t k = 5; k > 0; --k)
            sum = reach * (std::abs(c[k]) + sum);
        return sum;
    }
};

inline double length_of(double x, double y) {
    return std::sqrt(x * x + y * y);
} // std::hypot is five times slower

/// A step of the solution as a polynomial.
struct Piece {
    double start = 0.0, length = 0.0;
    std::array<Quintic, 4> p;

    Piece half(bool upper) const {
        Piece piece{start + (upper ? 0.5 * length : 0.0), 0.5 * length, {}};
        for (std::size_t k = 0; k < p.size(); ++k)
            piece.p[k] = p[k].half(upper ? 0.5 : -0.5);
        return piece;
    }
    double separation(double v) const { return length_of(p[0].at(v), p[1].at(v)); }
    double place_excursion(double reach) const {
        double sum = 0.0;
        for (std::size_t k = 5; k > 0; --k)
            sum = reach * (length_of(p[0].c[k], p[1].c[k]) + sum);
        return sum;
    }
    /// How far (w+, w-) and the phases go from those at v = 0: ln of 1 + the relative change.
    double wandering(double reach, double distance) const {
        return std::log1p(std::numbers::sqrt2 * place_excursion(reach) / distance) + p[2].excursion(reach) +
               p[3].excursion(reach);
    }
};

/// 4 M rho^-n/(rho - 1): error of interpolation at the nodes of what M bounds in the ellipse rho.
inline double remainder_factor(double rho) {
    const double cube = rho * rho * rho;
    return rho > 1.0 ? 4.0 / (cube * cube * (rho - 1.0)) : HUGE_VAL;
}

/// An ellipse in which the piece wanders no farther than `room`, near the largest; 1: none. `whole`: how far
/// it does for |v| <= 1.
inline double ellipse_of(const Piece& piece, double distance, double whole, double room) {
    constexpr double farthest = 32.0;
    for (double reach = std::min(farthest, room / whole); reach > 1.02; reach *= 0.85)
        if (piece.wandering(reach, distance) <= room)
            return reach + std::sqrt(reach * reach - 1.0);
    return 1.0;
}

} // namespace rodwake::rods
