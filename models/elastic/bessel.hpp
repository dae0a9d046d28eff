#pragma once
// Modified Bessel functions K0, K1 in the forms the field needs, each free of cancellation in its range.

namespace rodwake::elastic {

/// Two doubles in one vector register (SSE2 and NEON have it everywhere): the closed form is made of two
/// potentials of one shape, so both are worked out at once.
using Pair = double __attribute__((vector_size(16)));

/// K0, K1 and what survives on the wake axis, where K1 - K0 is 1/(2z) of its parts and d2 is 3/(4z^2) of
/// them.
struct Bessel {
    double k0, k1;
    double d1; ///< k1 - k0
    double d2; ///< k1/z - 2 d1
};

/// Below it the ascending series, above it the fits of bessel_tail.inc.
inline constexpr double series_end = 0.5;

/// Times e^z, z > series_end, from t = 1/z and root = sqrt(pi t/2). Relative error of k0, k1, d1 <= 4 ulp and
/// of d2 <= 6 ulp, for exact t and root.
Bessel scaled_bessel(double t, double root);

/// Themselves, 1e-120 < z <= series_end. Relative error of k0, k1 <= 3 ulp, of d1, d2 <= 6 ulp.
Bessel plain_bessel(double z);

/// K0(z) and K1(z) - 1/z, 0 < z <= series_end, at two arguments; log_half is ln(z/2).
/// Relative error of k0 <= 3 ulp, of kappa1 <= 4 ulp.
struct CoreBessel {
    Pair k0;
    Pair kappa1; ///< K1(z) - 1/z
};
CoreBessel core_bessel(Pair z, Pair log_half);

} // namespace rodwake::elastic
