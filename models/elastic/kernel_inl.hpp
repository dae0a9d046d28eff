// Strain and polar vectors of a rod's wake, a point a lane (include after foreach_target.h). Lanes may have
// media of their own. Formulas: elastic/field.hpp; here in terms of scaled K0 and M = e^(-a X) z K1(z), z = a
// s:
//
//   K = e_T k0_T - nu^2 e_L k0_L,   N = M_T - M_L,   c = X/s, q = Y/s, h = q^2 - c^2
//   D_YY = q^2 K + h N/s^2,   D_XY + d_Y G_T = q [c (K + 2 N/s^2) - nu^2 e_L k1_L],
//   nu d_X G_L = -nu^2 e_L (k0_L + c k1_L)
//
// Near the rod N is formed from e_T/e_L - 1 and z K1 - 1, because M_T and M_L are nearly equal there; far
// from it from the products, because there the former loses what is small. On the wake axis K0 and K1 cancel:
// 1 + c and K1 - K0 are used instead.

#if defined(RODWAKE_ELASTIC_KERNEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_ELASTIC_KERNEL_INL
#undef RODWAKE_ELASTIC_KERNEL_INL
#else
#define RODWAKE_ELASTIC_KERNEL_INL
#endif

#include "elastic/bessel_table.hpp"
#include "elastic/vector_math_inl.hpp"

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

/// Coefficient k of each lane's row in vector k.
template<class D>
struct Rows {
    hn::Vec<D> c[full_shape.terms];
};

#if HWY_MAX_BYTES >= 32
template<class D>
HWY_INLINE void TransposeFour(D d, const double* const (&row)[4], Rows<D>& rows) {
    for (int half = 0; half < 2; ++half) {
        const auto r0 = hn::LoadU(d, row[0] + 4 * half), r1 = hn::LoadU(d, row[1] + 4 * half),
                   r2 = hn::LoadU(d, row[2] + 4 * half), r3 = hn::LoadU(d, row[3] + 4 * half);
        const auto even01 = hn::InterleaveLower(d, r0, r1), even23 = hn::InterleaveLower(d, r2, r3),
                   odd01 = hn::InterleaveUpper(d, r0, r1), odd23 = hn::InterleaveUpper(d, r2, r3);
        rows.c[4 * half] = hn::ConcatLowerLower(d, even23, even01);
        rows.c[4 * half + 1] = hn::ConcatLowerLower(d, odd23, odd01);
        rows.c[4 * half + 2] = hn::ConcatUpperUpper(d, even23, even01);
        rows.c[4 * half + 3] = hn::ConcatUpperUpper(d, odd23, odd01);
    }
}
#endif

/// The rows of the table at these indices. Loading and transposing four rows beats gathering their columns.
template<class D, class Index>
HWY_INLINE Rows<D> LoadRows(D d, const double* table, Index index) {
    static_assert(full_shape.terms == 8);
    Rows<D> rows;
#if HWY_MAX_BYTES >= 32
    if constexpr (hn::MaxLanes(D()) == 4) {
        HWY_ALIGN std::int64_t at[4];
        hn::Store(index, hn::RebindToSigned<D>(), at);
        const double* const row[4] = {table + at[0], table + at[1], table + at[2], table + at[3]};
        TransposeFour(d, row, rows);
        return rows;
    }
#endif
    for (int k = 0; k < full_shape.terms; ++k)
        rows.c[k] = hn::GatherIndex(d, table + k, index);
    return rows;
}

/// Scaled K0 and K1 in the forms that do not cancel.
template<class D>
struct ScaledBessel {
    hn::Vec<D> k0;       ///< e^z K0
    hn::Vec<D> zk1;      ///< e^z z K1
    hn::Vec<D> zk1_less; ///< e^z z K1 - 1; absolute error of z ulp
    hn::Vec<D> zd;       ///< e^z z (K1 - K0)
};

/// 1/2, 1/3, ...: of (-ln(1 - t) - t)/t^2; |t| <= 1/64, so the next term is 6e-18.
inline constexpr double log_series[] = {1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7, 1.0 / 8};

/// Row of the table and middle of the piece that holds an argument.
template<class D>
struct Piece {
    hn::VFromD<hn::RebindToSigned<D>> index;
    hn::Vec<D> middle;
};

template<class D, class V = hn::Vec<D>>
HWY_INLINE Piece<D> PieceOf(D d, V z) {
    const hn::RebindToUnsigned<D> u;
    const hn::RebindToSigned<D> i;
    constexpr int shift = 52 - full_shape.piece_bits;
    constexpr std::uint64_t mask = ~((std::uint64_t{1} << shift) - 1), half = std::uint64_t{1} << (shift - 1);
    constexpr std::int64_t first = static_cast<std::int64_t>(1023 + lowest_binade) << full_shape.piece_bits;
    const auto bits = hn::BitCast(u, z);
    const auto number = hn::Sub(hn::BitCast(i, hn::ShiftRight<shift>(bits)), hn::Set(i, first));
    return {hn::ShiftLeft<3>(number),
            hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(u, mask)), hn::Set(u, half)))};
}

/// At n arguments in the table's range; `inverse` is 1/z.
template<std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void BesselAt(D d, const double* table, const V (&z)[n], const V (&inverse)[n],
                         ScaledBessel<D> (&result)[n]) {
    const V one = hn::Set(d, 1.0);
    Rows<D> rows[n];
    V p[n], derivative[n], t[n], log[n];
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        const Piece<D> piece = PieceOf(d, z[i]);
        rows[i] = LoadRows(d, table, piece.index);
        t[i] = hn::Mul(hn::Sub(z[i], piece.middle), inverse[i]);
        derivative[i] = rows[i].c[7];
        p[i] = Fma(d, derivative[i], t[i], rows[i].c[6]);
    }
    RODWAKE_UNROLL
    for (int k = 5; k >= 0; --k) // both by Horner's rule at once
        RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        derivative[i] = Fma(d, derivative[i], t[i], p[i]);
        p[i] = Fma(d, p[i], t[i], rows[i].c[k]);
    }
    Polynomials(d, t, log_series, log);
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        const V slope = Fma(d, hn::Neg(t[i]), derivative[i], derivative[i]); // z dP/dz
        const auto low = hn::Lt(z[i], one);
        const V ln = Fma(d, hn::Mul(t[i], t[i]), log[i], t[i]); // ln(z/z_i)
        ScaledBessel<D>& k = result[i];
        k.k0 = hn::Sub(p[i], hn::IfThenElseZero(low, ln));
        k.zd = hn::Sub(hn::IfThenElseZero(low, one), slope);
        const V sum = Fma(d, z[i], k.k0, hn::Neg(slope));
        k.zk1_less = hn::Sub(sum, hn::IfThenZeroElse(low, one));
        k.zk1 = hn::Add(sum, hn::IfThenElseZero(low, one));
    }
}

/// A medium of 0 <= eta: reduced constants of each lane.
template<class D>
struct LaneMedium {
    hn::Vec<D> c_shear;    ///< 1/(2 xi)
    hn::Vec<D> nu, delta;  ///< 1/(1 + eta), 1 - nu
    hn::Vec<D> inverse_nu; ///< 1 + eta
};

/// What depends on the distance alone: both rods of a pair share it.
template<class D>
struct Radial {
    hn::Vec<D> s, inverse; ///< r c_shear and 1/s
    ScaledBessel<D> shear, longitudinal;
    hn::Mask<D> in_range; ///< false: not finite, at the rod or beyond the table; the rest is then meaningless
};

/// Of n distances; lengths in units of 1/c_shear.
template<std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void RadialAt(D d, const double* table, const V (&distance)[n], const LaneMedium<D>& medium,
                         Radial<D> (&at)[n]) {
    const V low = hn::Set(d, 1.0 / static_cast<double>(std::uint64_t{1} << -lowest_binade)),
            high = hn::Set(d, static_cast<double>(std::uint64_t{1} << end_binade)), one = hn::Set(d, 1.0);
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        const V longitudinal = hn::Mul(distance[i], medium.nu);
        at[i].in_range = hn::And(hn::Ge(longitudinal, low), hn::Lt(distance[i], high));
        at[i].s = hn::IfThenElse(at[i].in_range, distance[i], one);
        at[i].inverse = hn::Div(one, at[i].s);
    }
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        const V z[2] = {at[i].s, hn::IfThenElse(at[i].in_range, hn::Mul(at[i].s, medium.nu), one)};
        const V inverse[2] = {at[i].inverse, hn::Mul(at[i].inverse, medium.inverse_nu)};
        ScaledBessel<D> k[2];
        BesselAt(d, table, z, inverse, k);
        at[i].shear = k[0];
        at[i].longitudinal = k[1];
    }
}

/// The field in the rod's frame but for its unit: strain times 2 pi/c_shear, polar vectors times 2
/// pi/c_shear^2.
template<class D>
struct Wake {
    hn::Vec<D> trace, yy, shear;         ///< div U, eps_yy - eps_xx = yy - trace, 2 eps_xy = shear
    hn::Vec<D> laplacian_x, laplacian_y; ///< lap U; zero unless asked for
    hn::Vec<D> gradient_x, gradient_y;   ///< grad div U
};

/// Where a point is, in units of 1/c_shear, and what decays there.
template<class D>
struct Bearing {
    hn::Vec<D> c, q, p;        ///< X/s, Y/s, 1 + c
    hn::Vec<D> e_l, e_t;       ///< exp(-nu (s + X)), exp(-(s + X))
    hn::Vec<D> ratio_less_one; ///< e_t/e_l - 1
};

template<std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void BearingsOf(D d, const V (&X)[n], const V (&Y)[n], const Radial<D>* const (&at)[n],
                           const LaneMedium<D>& m, Bearing<D> (&result)[n]) {
    V exponent[2 * n];
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        // w = s + X, behind the rod by Y^2/(s - X)
        const V far = hn::Add(at[i]->s, hn::Abs(X[i])), near = hn::Div(hn::Mul(Y[i], Y[i]), far);
        const V w = hn::IfThenElse(hn::Ge(X[i], hn::Zero(d)), far, near);
        result[i].c = hn::Mul(X[i], at[i]->inverse);
        result[i].q = hn::Mul(Y[i], at[i]->inverse);
        result[i].p = hn::Mul(w, at[i]->inverse);
        exponent[2 * i] = hn::Mul(m.nu, w);
        exponent[2 * i + 1] = hn::Mul(m.delta, w);
    }
    Exponential<D> e[2 * n];
    ExpMinus(d, exponent, e);
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        result[i].e_l = e[2 * i].value;
        result[i].e_t = hn::Mul(e[2 * i].value, e[2 * i + 1].value);
        result[i].ratio_less_one = e[2 * i + 1].less_one;
    }
}

/// The field at a point from its parts.
template<bool polar, class D, class V = hn::Vec<D>>
HWY_INLINE Wake<D> WakeFrom(D d, const Bearing<D>& b, const Radial<D>& at, const LaneMedium<D>& m) {
    const V one = hn::Set(d, 1.0), two = hn::Set(d, 2.0);
    const V &c = b.c, &q = b.q, &p = b.p, &e_l = b.e_l, &e_t = b.e_t;
    const ScaledBessel<D>&t = at.shear, &l = at.longitudinal;
    const V core = hn::Mul(e_l, Fma(d, b.ratio_less_one, t.zk1, hn::Sub(t.zk1_less, l.zk1_less)));
    const V M_l = hn::Mul(e_l, l.zk1), plain = Fma(d, e_t, t.zk1, hn::Neg(M_l));
    const V n = hn::Mul(hn::IfThenElse(hn::Lt(at.s, one), core, plain), hn::Mul(at.inverse, at.inverse));
    const V t0 = hn::Mul(e_t, t.k0);
    const V l0 = hn::Mul(hn::Mul(e_l, hn::Mul(m.nu, m.nu)), l.k0);       // nu^2 e_L k0_L
    const V ld = hn::Mul(hn::Mul(e_l, m.nu), hn::Mul(at.inverse, l.zd)); // nu^2 e_L (k1_L - k0_L)
    const V l1 = hn::Add(l0, ld);
    const V h = hn::Mul(hn::Sub(q, c), hn::Add(q, c)), qq = hn::Mul(q, q);
    Wake<D> wake;
    wake.trace = hn::Sub(ld, hn::Mul(p, l1));
    wake.yy = Fma(d, qq, hn::Sub(t0, l0), hn::Mul(h, n));
    wake.shear = hn::Mul(q, hn::Sub(hn::Mul(c, Fma(d, two, n, t0)), Fma(d, p, l0, ld)));
    wake.laplacian_x = wake.laplacian_y = wake.gradient_x = wake.gradient_y = hn::Zero(d);
    if constexpr (polar) {
        // G_T,YY + nu G_L,XX and nu G_L,XY - G_T,XY; (1 + c^2) k0 + 2 c k1 = p^2 k0 + 2 c (k1 - k0)
        const V square = hn::Mul(at.inverse, at.inverse), m_l = hn::Mul(M_l, square); // M_L/s^2
        const V l_xx = hn::Mul(m.nu, Fma(d, hn::Mul(p, p), l0, hn::Mul(hn::Mul(two, c), ld)));
        const V l_xy = hn::Mul(hn::Mul(m.nu, q), Fma(d, p, l0, ld));
        const V both = Fma(d, m.delta, m_l, n), cq2 = hn::Mul(two, hn::Mul(c, q));
        const V t_xy = hn::Mul(q, Fma(d, p, t0, hn::Mul(hn::Mul(e_t, at.inverse), t.zd)));
        wake.laplacian_x = hn::Add(Fma(d, qq, t0, hn::Mul(h, both)), l_xx);
        wake.laplacian_y = hn::Sub(hn::Sub(l_xy, t_xy), hn::Mul(cq2, both));
        wake.gradient_x = Fma(d, hn::Neg(h), hn::Mul(m.nu, m_l), l_xx);
        wake.gradient_y = Fma(d, cq2, hn::Mul(m.nu, m_l), l_xy);
    }
    return wake;
}

/// The field at n points (X, Y), lengths in units of 1/c_shear; at[i] is that of sqrt(X^2 + Y^2).
template<bool polar, std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void WakeAt(D d, const V (&X)[n], const V (&Y)[n], const Radial<D>* const (&at)[n],
                       const LaneMedium<D>& m, Wake<D> (&wake)[n]) {
    Bearing<D> bearing[n];
    BearingsOf(d, X, Y, at, m, bearing);
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i)
        wake[i] = WakeFrom<polar>(d, bearing[i], *at[i], m);
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
