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
/// most 2 ulp, on average below 0.5 (docs/validation.md).
void table_bessel(std::span<const double> z, std::span<double> k0, std::span<double> k1);

} // namespace rodwake::elastic
