#pragma once
// Near the rod, for wave numbers c up to 6 over the box: what the periodic potential has more than the
// infinite plane's. It is regular up to the nearest image, one box away:
//
//   rest = P + exp(-c.r) [ln(c) psi_0 + Re sum_m A_m psi_m],   psi_m = w^m m! (2/(c r))^m I_m(c r),  w = x +
//   i y
//
// P: periodic_uniform.hpp. The A_m come from the rest's values on a circle half a box wide (discrete Fourier
// transform); at r <= 0.32 terms beyond the last fall below 1e-13. Unit of length: the box's side.

#include "periodic_rows.hpp"

#include <array>

namespace rodwake::elastic {

class LocalRest {
public:
    /// Above it exp(2 c r) on the circle costs too many digits.
    static constexpr double largest_c = 6.0;

    /// `columns` along y, `rows` along x (built with exchanged axes).
    LocalRest(double c, double ux, double uy, const Rows& columns, const Rows& rows);

    void add(Jets& sum, double x, double y, Needed needed) const;

    static constexpr int terms = 28;

private:
    using Coefficients = std::array<Complex, terms>;
    struct Basis;
    struct Sums;
    static Sums sums(const Coefficients& a, const Basis& psi, double c);

    double c_, ux_, uy_;
    Coefficients a_{}, a_by_c_{};
};

} // namespace rodwake::elastic
