#pragma once
// The functions of exponential integrators for complex arguments (Cox & Matthews, J. Comput. Phys. 176, 430,
// 2002):
//
//   phi_0 = e^z,   phi_{k+1}(z) = (phi_k(z) - 1/k!)/z,   phi_k(0) = 1/k!
//
// Error below 4e-15 of phi_k, Re z <= 0: by that recurrence from |z| = 1 on, nearer to 0 by the series of
// phi_3 and the recurrence downwards, which loses nothing there.

#include "elastic/complex.hpp"

namespace rodwake::medium {

using fourier::Complex;

struct Phi {
    Complex zero, one, two, three;
};

/// At z; `exponential` = e^z.
Phi phi(Complex z, Complex exponential);

/// At 2 z from those at z: 2^k phi_k(2 z) = e^z phi_k(z) + sum_{l = 1}^{k} phi_l(z)/(k - l)!.
Phi doubled(const Phi& phi);

/// First divided differences (phi_k(a) - phi_k(b))/(a - b), for a = b the derivatives, of a and b both real
/// or conjugate, Re <= 0: they are real. With e^(a t) and e^(b t) those of two rates of one mode. Error:
/// below 2e-14 of the largest |phi_k| between them, also for a near b (tests/medium/test_phi.cpp): beyond |a
/// - b| = 1 by subtraction, nearer by Gauss-Legendre quadrature of the derivative phi_k' = phi_k - k
/// phi_{k+1} from b to a.
struct PhiDifferences {
    double zero, one, two, three;
};
PhiDifferences phi_differences(Complex a, Complex b);

} // namespace rodwake::medium
