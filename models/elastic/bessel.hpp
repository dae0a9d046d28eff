#pragma once
// Modified Bessel functions K0, K1 in the forms the field needs, each free of cancellation in its range.

namespace rodwake::elastic {

/// e^z K0, e^z K1 and their differences, z > 0. d1 and d2 are what survives on the wake axis, where K1 - K0
/// is 1/(2z) of its parts and d2 is 3/(4z^2) of them. Relative error of each <= 4 ulp for z >= 1; for z < 1,
/// d1 <= 6 ulp, d2 <= 20 ulp.
struct ScaledBessel {
    double k0, k1;
    double d1; ///< k1 - k0
    double d2; ///< k1/z - 2 d1 = -d(d1)/dz
};
ScaledBessel scaled_bessel(double z);

/// K0(z) and K1(z) - 1/z, unscaled, 0 < z <= 1, by their power series.
struct CoreBessel {
    double k0;
    double kappa1; ///< K1(z) - 1/z
};
CoreBessel core_bessel(double z);

} // namespace rodwake::elastic
