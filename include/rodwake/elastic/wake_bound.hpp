#pragma once
// How large a rod's strain and polar vectors can be at a place, at most: which rods cannot turn each other.
//
// Lengths in 2 xi: s = r/(2 xi), w = (r + x)/(2 xi) with x along the heading; w vanishes on the axis behind
// and is 2 s on the axis ahead. With b(z) = sqrt(pi/(2 z)) the scaled functions obey e^z K0(z) <= b and e^z
// (K1 - K0) <= b/(2 z) (K1/K0 < 1 + 1/(2 z): Yang and Chu 2017, J. Inequal. Appl. 41); |sin|^2 <= 2 w/s.
// E_m(a) is the largest w'^m exp(-a w') for w' >= w, and for a = 1 and a = nu = 1/(1 + eta)
//
//   B = b(a s) E_0,  P = b(a s) min(2 E_0, E_1/s),  Q = b(a s) min(E_0, 2 E_1/s),
//   R = b(a s) min(E_0, sqrt(2/s) E_(1/2)),         N = B (a s + 1/2)/s^2
//
// bound what the field is made of. In units of f/mu/(4 pi xi), with D = nu B_nu/(2 s):
//
//   |div u|           <= T = max(D, nu^2 P_nu + nu P_nu/(2 s))
//   |eps_yy - eps_xx| <= S = T + max(Q_1, nu^2 Q_nu) + max(N_1, N_nu)
//   2 |eps_xy|        <= H = 2 max(N_1, N_nu) + R_1 + nu^2 P_nu + D
//   |eps|             <= sqrt((T^2 + S^2 + H^2)/2),     |eps|^2 = eps_xx^2 + 2 eps_xy^2 + eps_yy^2
//
// and in units of f/mu/(8 pi xi^2), with L = sqrt(5) nu (nu^2 P_nu + D)
//
//   |grad div u| <= nu N_nu + L
//   |lap u|      <= max(N_1, N_nu) + |1 - nu| N_nu + L + Q_1 + P_1 + B_1/(2 s)
//
// All fall with s and with w: exponentially in w, as s^(-1) behind. Far from the rod they are a few times the
// largest value at that r and w or more (tests hold both sides); at r -> 0 they grow too fast.

#include "rodwake/elastic/medium.hpp"

namespace rodwake::elastic {

/// Bounds for places at least `distance` from the rod at which r + x is at least `ahead`; lengths in the unit
/// of medium.xi. distance > 0, ahead >= 0; at distance 0 the bounds are infinite, for NaN they are NaN.
class WakeBound {
public:
    /// Throws InputError for an illegal medium (see validate).
    explicit WakeBound(const Medium& medium);

    double strain(double distance, double ahead) const; ///< of the norm, f/mu per length
    double polar(double distance, double ahead) const;  ///< of the larger norm, f/mu per length^2

private:
    double c_shear_, nu_;
};

} // namespace rodwake::elastic
