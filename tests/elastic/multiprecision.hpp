#pragma once
// The number type of the oracle and the scaled Bessel functions in it.

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace rodwake::oracle {

/// 220 digits: the ascending series at z = 140 cancels 121 of them, third derivatives at r/xi = 1e-12
/// another 60.
using Real =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<220>, boost::multiprecision::et_off>;

/// e^z K0(z), e^z K1(z) to 95 digits or better, z > 0.
struct ScaledPair {
    Real k0, k1;
};
ScaledPair scaled_bessel(const Real& z);

} // namespace rodwake::oracle
