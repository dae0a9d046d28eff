#pragma once
// A pair's solution over a step as polynomials, and the points at which functions along it are expanded.
// docs/numerics.md, section 4.

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace rodwake::rods {

inline constexpr int degree = 12, nodes = degree + 1; ///< of expansions over a step

/// Chebyshev points of the second kind, -1 to 1.
inline constexpr double half_root3 = 0.5 * std::numbers::sqrt3, half_root2 = 0.5 * std::numbers::sqrt2,
                        cosine15 = half_root2 * (half_root3 + 0.5), sine15 = half_root2 * (half_root3 - 0.5);
inline constexpr std::array<double, nodes> node_at{
    -1.0,   -cosine15, -half_root3, -half_root2, -0.5,     -sine15, 0.0,
    sine15, 0.5,       half_root2,  half_root3,  cosine15, 1.0};

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
    /// |p'| on -1 to 1, at most.
    double steepest() const {
        return std::abs(c[1]) + 2.0 * std::abs(c[2]) + 3.0 * std::abs(c[3]) + 4.0 * std::abs(c[4]) +
               5.0 * std::abs(c[5]);
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
        const double middle = upper ? 0.5 : -0.5;
        for (std::size_t i = 0; i < p.size(); ++i) {
            std::array<double, 6>& c = piece.p[i].c;
            c = {};
            for (std::size_t k = 6; k-- > 0;) { // Horner's rule with v = middle + u/2
                for (std::size_t j = 5; j > 0; --j)
                    c[j] = middle * c[j] + 0.5 * c[j - 1];
                c[0] = middle * c[0] + p[i].c[k];
            }
        }
        return piece;
    }
    double separation(double v) const { return length_of(p[0].at(v), p[1].at(v)); }
    double place_excursion(double reach) const {
        double sum = 0.0;
        for (std::size_t k = 5; k > 0; --k)
            sum = reach * (length_of(p[0].c[k], p[1].c[k]) + sum);
        return sum;
    }
};

} // namespace rodwake::rods
