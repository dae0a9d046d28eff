#pragma once
// The field of a rod that turns, to first order in its turning rate (docs/memory.md, Eq. 38).
//
// A rod that has always walked straight has the mode u_q = f_q e(n)/z, z = lambda - i q.n, with lambda the
// mode's decay, f_q its force (modal_field.hpp) and e(n) the component of the heading n along q/|q| or z x
// q/|q|. One that turns at theta' has, with n' = z x n = dn/dtheta,
//
//   u_q = f_q [e(n)/z - theta' (e(n')/z^2 + i (q.n') e(n)/z^3)] + O(theta'^2, theta'')
//
// the expansion of f_q int_0^inf e^(-lambda s) e(n(t - s)) e^(-i q.(R(t - s) - R(t))) ds; the bracket's
// second part is -1/z d/dtheta of the first, at a fixed place. In the rod's frame on the plane: U = U0 +
// theta' U1,
//
//   -alpha d_x U1 - lap U1 - eta grad div U1 = alpha (d_phi - z x) U0,   d_phi = x d_y - y d_x
//
// Valid where theta' changes little, and theta' tau is small, over the time tau that a field takes to get to
// the place, about alpha r^2/4 at a distance r, or r behind the rod if that is less
// (studies/reports/medium.md). Error: the next order of the expansion; the sum itself is exact but for
// rounding.

#include "rodwake/medium/modal_field.hpp"

namespace rodwake::medium {

/// Adds `rate` U1 of a rod: what turning at `rate`, rad mu v0/f, counter-clockwise, adds to its field.
void add_turning(const ModalField& modes, const rods::Pose& rod, double rate, std::span<double> field);

} // namespace rodwake::medium
