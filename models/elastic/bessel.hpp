#pragma once
// K0 and K1 as short polynomials on many pieces, for the batched kernels (kernel_inl.hpp): a piece is found
// from the bits of its argument, without a logarithm or a branch.
//
// A binade [2^e, 2^(e+1)) has 2^piece_bits pieces of equal width. With z_i the middle of the piece and
// t = (z - z_i)/z, a row holds the coefficients in t of
//
//   z < 1:   e^z K0(z) + ln z - ln z_i     regular at 0 but for z ln z; ln(z/z_i) = -ln(1 - t)
//   z >= 1:  e^z K0(z)
//
// z K1 follows from the derivative z d/dz = (1 - t) d/dt, which is what the polynomials are fitted for.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rodwake::elastic {

/// Arguments the tables hold: 2^lowest_binade <= z < 2^end_binade.
inline constexpr int lowest_binade = -44, end_binade = 20;

/// Accuracy of a table: pieces a binade and coefficients a row. `full_shape` has a cache line a row and
/// errors below the last bit of K0 and K1; half its pieces would lose two digits of z K1 - 1 at small z. The
/// others are those of Accuracy::fine and Accuracy::single.
struct TableShape {
    int piece_bits, terms;

    /// Numbers from row to row, a power of two: what a row lacks are zeros.
    constexpr int stride() const { return terms > 4 ? 8 : 4; }
};
inline constexpr TableShape full_shape{6, 8}, fine_shape{5, 6}, single_shape{5, 4};

template<class Real>
struct BesselTable {
    std::vector<Real> coefficients; ///< rows of `stride`, from the lowest binade on

    const Real* rows() const { return coefficients.data(); }
};

/// The table of a shape, in the working precision `Real`. Takes some milliseconds: ask for bessel_table
/// instead.
template<class Real>
BesselTable<Real> make_bessel_table(TableShape shape);

/// Made at the first call, thread-safe; a few milliseconds then, nothing later.
const BesselTable<double>& bessel_table();
const BesselTable<double>& fine_bessel_table();
const BesselTable<float>& single_bessel_table();

/// e^z K0(z) and e^z K1(z) as the kernels have them, z in the range above; spans of one length. Error: at
/// most 2 ulp, on average below 0.5 (studies/reports/elastic.md).
void table_bessel(std::span<const double> z, std::span<double> k0, std::span<double> k1);

// Modified Bessel functions K0, K1 in the forms the field needs, each free of cancellation in its range.

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
