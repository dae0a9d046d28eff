#pragma once
// Modified Bessel functions K0, K1 in the forms the field needs, each free of cancellation in its range.

#include "pair.hpp"

namespace rodwake::elastic {

/// K0, K1 and what survives on the wake axis, where K1 - K0 is 1/(2z) of its parts and d2 is 3/(4z^2) of
/// them.
struct Bessel {
    double k0, k1;
    double d1; ///< k1 - k0
    double d2; ///< k1/z - 2 d1
};

/// Below it the ascending series, above it the fits of bessel_tail.inc.
inline constexpr double series_end = 0.5;

/// Times e^z, z > series_end.
Bessel scaled_bessel(double z);

/// Themselves, 0 < z <= series_end.
Bessel plain_bessel(double z);

/// K0(z) and K1(z) - 1/z, 0 < z <= series_end, at two arguments; log_half is ln(z/2).
struct CoreBessel {
    Pair k0;
    Pair kappa1; ///< K1(z) - 1/z
};
CoreBessel core_bessel(Pair z, Pair log_half);

} // namespace rodwake::elastic
