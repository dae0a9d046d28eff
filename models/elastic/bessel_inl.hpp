// Scaled K0 and K1 from the rows of a table, an argument a lane (include after foreach_target.h). The shape
// of the table sets the accuracy, the type of the lanes the working precision.

#if defined(RODWAKE_ELASTIC_BESSEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_ELASTIC_BESSEL_INL
#undef RODWAKE_ELASTIC_BESSEL_INL
#else
#define RODWAKE_ELASTIC_BESSEL_INL
#endif

#include "bessel.hpp"
#include "vector_math_inl.hpp"

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

/// Coefficient k of each lane's row in vector k.
template<class D, TableShape shape>
struct CoefficientRows {
    hn::Vec<D> c[shape.stride()];
};

#if HWY_TARGET != HWY_SCALAR && !HWY_HAVE_SCALABLE
/// Blocks of 128 bits, one of each row at at[0], at[block], at[2 block] ...: loads that put them in place
/// spare the shuffles of a transposition.
template<class D, class Index>
HWY_INLINE hn::Vec<D> RowBlocks(D d, const hn::TFromD<D>* from, const Index* at) {
    constexpr std::size_t lanes = hn::MaxLanes(D());
    if constexpr (lanes * sizeof(hn::TFromD<D>) == 16) {
        return hn::LoadU(d, from + at[0]);
    } else {
        const hn::Half<D> half;
        return hn::Combine(d, RowBlocks(half, from, at + lanes / 2), RowBlocks(half, from, at));
    }
}

template<TableShape shape, class D, class Index>
HWY_INLINE void TransposeRows(D d, const double* table, const Index* at, CoefficientRows<D, shape>& rows) {
    RODWAKE_UNROLL
    for (int k = 0; k < shape.terms; k += 2) {
        const auto even = RowBlocks(d, table + k, at), odd = RowBlocks(d, table + k, at + 1);
        rows.c[k] = hn::InterleaveLower(d, even, odd);
        rows.c[k + 1] = hn::InterleaveUpper(d, even, odd);
    }
}

/// A row of floats is one block.
template<TableShape shape, class D, class Index>
HWY_INLINE void TransposeRows(D d, const float* table, const Index* at, CoefficientRows<D, shape>& rows) {
    static_assert(shape.stride() == 4);
    const auto r0 = RowBlocks(d, table, at), r1 = RowBlocks(d, table, at + 1),
               r2 = RowBlocks(d, table, at + 2), r3 = RowBlocks(d, table, at + 3);
    const hn::RepartitionToWide<D> w; // two neighbours as one
    const auto low01 = hn::BitCast(w, hn::InterleaveLower(d, r0, r1)),
               low23 = hn::BitCast(w, hn::InterleaveLower(d, r2, r3)),
               high01 = hn::BitCast(w, hn::InterleaveUpper(d, r0, r1)),
               high23 = hn::BitCast(w, hn::InterleaveUpper(d, r2, r3));
    rows.c[0] = hn::BitCast(d, hn::InterleaveLower(w, low01, low23));
    rows.c[1] = hn::BitCast(d, hn::InterleaveUpper(w, low01, low23));
    rows.c[2] = hn::BitCast(d, hn::InterleaveLower(w, high01, high23));
    rows.c[3] = hn::BitCast(d, hn::InterleaveUpper(w, high01, high23));
}
#endif

/// The rows of the table at these indices. Loading and transposing rows beats gathering their columns.
template<TableShape shape, class D, class Index>
HWY_INLINE CoefficientRows<D, shape> LoadRows(D d, const hn::TFromD<D>* table, Index index) {
    CoefficientRows<D, shape> rows;
    if constexpr (hn::MaxLanes(D()) == 1) {
        const hn::TFromD<D>* const row = table + hn::GetLane(index);
        RODWAKE_UNROLL
        for (int k = 0; k < shape.terms; ++k)
            rows.c[k] = hn::Set(d, row[k]);
        return rows;
    }
#if HWY_TARGET != HWY_SCALAR && !HWY_HAVE_SCALABLE
    if constexpr (hn::MaxLanes(D()) * sizeof(hn::TFromD<D>) >= 16) {
        using Index1 = hwy::MakeSigned<hn::TFromD<D>>;
        HWY_ALIGN Index1 at[hn::MaxLanes(D())];
        if constexpr (hn::MaxLanes(D()) == 2) { // not through memory
            at[0] = hn::GetLane(index);
            at[1] = hn::ExtractLane(index, 1);
        } else {
            hn::Store(index, hn::RebindToSigned<D>(), at);
        }
        TransposeRows(d, table, at, rows);
        return rows;
    }
#endif
    RODWAKE_UNROLL
    for (int k = 0; k < shape.terms; ++k)
        rows.c[k] = hn::GatherIndex(d, table + k, index);
    return rows;
}

/// Scaled K0 and K1 in the forms that do not cancel.
template<class D>
struct ScaledBessel {
    hn::Vec<D> k0;       ///< e^z K0
    hn::Vec<D> zk1;      ///< e^z z K1
    hn::Vec<D> zk1_less; ///< e^z z K1 - 1, absolute error of z ulp, for z < 1; e^z z K1 beyond
    hn::Vec<D> zd;       ///< e^z z (K1 - K0)
};

/// 1/2, 1/3, ...: of (-ln(1 - t) - t)/t^2. After 6 terms for |t| <= 1/128 the next is 2e-18; after 4
/// for |t| <= 1/32 it is 2e-10.
inline constexpr double log_series[] = {1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7};
constexpr std::size_t log_terms(TableShape shape) { return shape.piece_bits > 5 ? 6 : 4; }

/// Row of the table and middle of the piece that holds an argument.
template<class D>
struct TablePiece {
    hn::VFromD<hn::RebindToSigned<D>> index;
    hn::Vec<D> middle;
};

template<TableShape shape, class D, class V = hn::Vec<D>>
HWY_INLINE TablePiece<D> PieceOf(D d, V z) {
    using Real = hn::TFromD<D>;
    using Signed = hwy::MakeSigned<Real>;
    using Unsigned = hwy::MakeUnsigned<Real>;
    const hn::RebindToUnsigned<D> u;
    const hn::RebindToSigned<D> i;
    constexpr int shift = hwy::MantissaBits<Real>() - shape.piece_bits, bias = sizeof(Real) == 4 ? 127 : 1023;
    constexpr Unsigned mask = ~((Unsigned{1} << shift) - 1), half = Unsigned{1} << (shift - 1);
    constexpr Signed first = static_cast<Signed>(bias + lowest_binade) << shape.piece_bits;
    const auto bits = hn::BitCast(u, z);
    const auto number = hn::Sub(hn::BitCast(i, hn::ShiftRight<shift>(bits)), hn::Set(i, first));
    return {hn::ShiftLeft < shape.stride() == 8 ? 3 : 2 > (number),
            hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(u, mask)), hn::Set(u, half)))};
}

/// At n arguments in the table's range; `inverse` is 1/z.
template<TableShape shape, std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void BesselAt(D d, const hn::TFromD<D>* table, const V (&z)[n], const V (&inverse)[n],
                         ScaledBessel<D> (&result)[n]) {
    const V one = hn::Set(d, hn::TFromD<D>{1});
    CoefficientRows<D, shape> rows[n];
    V p[n], derivative[n], t[n], log[n];
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        const TablePiece<D> piece = PieceOf<shape>(d, z[i]);
        rows[i] = LoadRows<shape>(d, table, piece.index);
        t[i] = hn::Mul(hn::Sub(z[i], piece.middle), inverse[i]);
        derivative[i] = rows[i].c[shape.terms - 1];
        p[i] = Fma(d, derivative[i], t[i], rows[i].c[shape.terms - 2]);
    }
    RODWAKE_UNROLL
    for (int k = shape.terms - 3; k > 0; --k) // both by Horner's rule at once
        RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        derivative[i] = Fma(d, derivative[i], t[i], p[i]);
        p[i] = Fma(d, p[i], t[i], rows[i].c[k]);
    }
    Polynomials<log_terms(shape)>(d, t, log_series, log);
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        derivative[i] = Fma(d, derivative[i], t[i], p[i]);
        const V slope = Fnma(d, t[i], derivative[i], derivative[i]); // z dP/dz
        const auto low = hn::Lt(z[i], one);
        const V ln = Fma(d, hn::Mul(t[i], t[i]), log[i], t[i]); // ln(z/z_i)
        const V unit = hn::IfThenElseZero(low, one);
        ScaledBessel<D>& k = result[i];
        // what is small first: one rounding of the result's size
        k.k0 = hn::Add(rows[i].c[0], Fms(d, p[i], t[i], hn::IfThenElseZero(low, ln)));
        k.zd = hn::Sub(unit, slope);
        k.zk1_less = Fms(d, z[i], k.k0, slope);
        k.zk1 = hn::Add(k.zk1_less, unit);
    }
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
