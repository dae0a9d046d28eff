#pragma once
// Near the rod, for wave numbers c up to 6 over the box's shorter side: what the periodic potential has more
// than the infinite plane's. It is regular up to the nearest image, one shorter side away:
//
//   rest = P/(X Y) + exp(-c.r) [ln(c) psi_0 + Re sum_m A_m psi_m],
//   psi_m = w^m m! (2/(c r))^m I_m(c r),   w = x + i y
//
// P: uniform_part below. The A_m come from the rest's values on a circle of radius 1/2 (discrete Fourier
// transform); at r <= 0.32 terms beyond the last fall below 1e-13. Unit of length: the shorter side.

#include "periodic_jet.hpp"
#include "periodic_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace rodwake::elastic {

class LocalRest {
public:
    /// Above it exp(2 c r) on the circle costs too many digits.
    static constexpr double largest_c = 6.0;

    /// `columns` along y, `rows` along x (built with exchanged axes).
    LocalRest(const WaveVector& c, const PeriodicBox& box, const PeriodicRows& columns,
              const PeriodicRows& rows);

    void add(WaveVectorJets& sum, double x, double y, Needed needed) const;

    static constexpr int terms = 28;

private:
    using Coefficients = std::array<Complex, terms>;
    struct Basis;
    struct Sums;
    static Sums sums(const Coefficients& a, const Basis& psi, double c, Needed needed);

    WaveVector c_;
    double density_; ///< of the counterforce, 1/(X Y)
    Coefficients a_{}, a_by_c_{};
};

// What a uniform counterforce of density 1 adds to a potential near the rod, regular for c -> 0:
//
//   lap P + 2 c d_x P = 2 pi,   P = (pi/c^2) (c x - 1 + exp(-c x) I0(c r)),   x along the heading

/// P and its derivative by c at (x, y), second derivatives and all; third ones if needed. For |c| r <= 5.
WaveVectorJets uniform_part(double c, double x, double y, bool third = false);

/// The same without derivatives by place; by_angle = (x d_y - y d_x) P.
struct UniformValue {
    double g, by_c, by_angle;
};
UniformValue uniform_value(double c, double x, double y);

/// (I0(2 sqrt t) - 1)/t.
double bessel_rest(double t);

/// 0F1(; m+1; t) = m! (2/z)^m I_m(z), t = z^2/4.
double bessel_ratio(int m, double t);

// One potential of the periodic box,
//
//   lap G + 2 c.grad G = -2 pi (delta_per - 1/(X Y)),    c = c (ux, uy), of zero mean over the box
//
// in the cell |x| <= X/2, |y| <= Y/2 about the rod, the sides in units of the shorter one. Far from the rod
// it is summed as columns or rows, whichever the place is farther from; near it, what it has more than the
// infinite plane's exp(-c.r) K0(c r) is.

/// |x| and |y| below it: near.
inline constexpr double near_rod = 0.22;
inline bool is_near(double x, double y) { return std::max(std::abs(x), std::abs(y)) < near_rod; }

class PeriodicPotential {
public:
    PeriodicPotential(const WaveVector& c, const PeriodicBox& box);

    /// Far: the whole potential; near: without the infinite plane's.
    WaveVectorJets at(double x, double y, Needed needed) const;

    double c() const { return c_.c; }

private:
    WaveVector c_;
    PeriodicBox box_;
    PeriodicRows columns_, rows_; ///< rows: with x and y exchanged
    std::optional<LocalRest> local_;
};

} // namespace rodwake::elastic
