#pragma once
// What the uniform counterforce of the periodic box adds to a potential near the rod, regular for c -> 0:
//
//   lap P + 2 c d_x P = 2 pi,   P = (pi/c^2) (c x - 1 + exp(-c x) I0(c r)),   x along the heading

#include "periodic_jet.hpp"

namespace rodwake::elastic {

/// P and its derivative by c at (x, y), second derivatives and all. For |c| r <= 5.
Jets uniform_part(double c, double x, double y);

/// The same without derivatives by place.
struct UniformValue {
    double g, by_c;
};
UniformValue uniform_value(double c, double x, double r_square);

/// (I0(2 sqrt t) - 1)/t.
double bessel_rest(double t);

/// 0F1(; m+1; t) = m! (2/z)^m I_m(z), t = z^2/4.
double bessel_ratio(int m, double t);

} // namespace rodwake::elastic
