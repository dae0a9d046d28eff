#include "multiprecision.hpp"

#include <boost/math/constants/constants.hpp>

namespace rodwake::oracle {

namespace {

/// Above it the smallest term of the asymptotic series is below e^(-2 z) = 1e-121; below it the ascending
/// series keeps 220 - 121 digits.
constexpr double switch_over = 140.0;

/// K0 by DLMF 10.31.2, K1 from the Wronskian I0 K1 + I1 K0 = 1/z.
ScaledPair ascending(const Real& z) {
    const Real t = z * z / 4, tiny = ldexp(Real(1), -760);
    Real term = 1, harmonic = 0, i0 = 1, i1 = 1, regular = 0;
    for (int k = 1; term > tiny * i0; ++k) {
        term *= t / (k * k);
        harmonic += Real(1) / k;
        i0 += term;
        i1 += term / (k + 1);
        regular += harmonic * term;
    }
    i1 *= z / 2;
    const Real k0 = regular - (log(z / 2) + boost::math::constants::euler<Real>()) * i0;
    const Real scale = exp(z);
    return {scale * k0, scale * (1 / z - i1 * k0) / i0};
}

/// DLMF 10.40.2.
Real asymptotic(int order, const Real& z) {
    Real term = 1, sum = 1;
    const Real tiny = ldexp(Real(1), -760);
    for (int k = 1; k < 270; ++k) {
        const int odd = 2 * k - 1;
        term *= Real(4 * order * order - odd * odd) / (8 * k * z);
        sum += term;
        if (abs(term) < tiny)
            break;
    }
    return sum * sqrt(boost::math::constants::half_pi<Real>() / z);
}

} // namespace

ScaledPair scaled_bessel(const Real& z) {
    if (z < switch_over)
        return ascending(z);
    return {asymptotic(0, z), asymptotic(1, z)};
}

} // namespace rodwake::oracle
