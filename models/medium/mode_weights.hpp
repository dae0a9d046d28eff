#pragma once
// Weights of one mode in a step of h by the exponential Runge-Kutta method of order 4, ETDRK4 in the form of
// Krogstad (J. Comput. Phys. 203, 72, 2005), for
//
//   b u'' + u' = -lambda u + f(t)          (units of time: b, 1/lambda)
//
// without inertia, b = 0, by phi_k(-h lambda). With inertia it is y' = A y + (0, f/b) of y = (u, u'), whose
// rates are r = (-1 +- sqrt(1 - 4 b lambda))/(2 b), and by Newton's interpolation
//
//   e^(h A) = e^z + E (h A - z),   phi_k(h A) (0, 1) = (h D_k, D_{k-1}),   z = h r_+, z' = h r_-
//
// with divided differences D_k = phi_k[z, z'], E = D_0 (phi.hpp): what decays, oscillates, or does both at
// once (z = z'), and free modes are exact. Error: some 1e-14 of the largest weight.

#include "phi.hpp"

#include <array>
#include <cstddef>

namespace rodwake::medium {

/// Of the forces at the four stages, times h.
struct ForceWeights {
    double half_one, half_two; ///< phi_1(z/2)/2, phi_2(z/2)
    double one, two, three;    ///< phi_k(z)
};

/// Without inertia.
struct DecayWeights {
    double half, full; ///< e^(-lambda h/2), e^(-lambda h)
    ForceWeights force;
};
DecayWeights decay_weights(double decay, double h);

/// With inertia.
struct WaveWeights {
    struct Propagator {
        double uu, uv, vu, vv; ///< (u, v) after = ((uu, uv), (vu, vv)) (u, v) before
    };
    Propagator half, full;
    ForceWeights u, v;
};
WaveWeights wave_weights(double decay, double inertia, double h);

/// What the forces f at the stages add up to at stage 1, 2, 3 or the end, 4; those of later stages are not
/// read.
inline double weighted(std::size_t stage, const ForceWeights& w, const std::array<double, 4>& f) {
    switch (stage) {
    case 1:
        return w.half_one * f[0];
    case 2:
        return (w.half_one - w.half_two) * f[0] + w.half_two * f[1];
    case 3:
        return (w.one - 2.0 * w.two) * f[0] + 2.0 * w.two * f[2];
    default:
        return (w.one - 3.0 * w.two + 4.0 * w.three) * f[0] + (2.0 * w.two - 4.0 * w.three) * (f[1] + f[2]) +
               (4.0 * w.three - w.two) * f[3];
    }
}

} // namespace rodwake::medium
