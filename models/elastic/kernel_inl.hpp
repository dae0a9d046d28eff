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

#include "bessel_inl.hpp"

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

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
template<TableShape shape = full_shape, std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void RadialAt(D d, const hn::TFromD<D>* table, const V (&distance)[n], const LaneMedium<D>& medium,
                         Radial<D> (&at)[n]) {
    using Real = hn::TFromD<D>;
    const V low = hn::Set(d, Real{1} / static_cast<Real>(std::uint64_t{1} << -lowest_binade)),
            high = hn::Set(d, static_cast<Real>(std::uint64_t{1} << end_binade)), one = hn::Set(d, Real{1});
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
        BesselAt<shape>(d, table, z, inverse, k);
        at[i].shear = k[0];
        at[i].longitudinal = k[1];
    }
}

/// The field in the rod's frame but for its unit: strain times 2 pi/c_shear, polar vectors times 2
/// pi/c_shear^2.
template<class D>
struct WakeLanes {
    hn::Vec<D> trace, yy, shear;         ///< div U, eps_yy - eps_xx = yy - trace, 2 eps_xy = shear
    hn::Vec<D> laplacian_x, laplacian_y; ///< lap U; zero unless asked for
    hn::Vec<D> gradient_x, gradient_y;   ///< grad div U
};

/// Terms of the exponential that go with a table.
constexpr std::size_t exponential_terms(TableShape shape) {
    return shape.terms == full_shape.terms ? 10 : shape.terms == fine_shape.terms ? 6 : 5;
}

/// Where a point is, in units of 1/c_shear, and what decays there.
template<class D>
struct Bearing {
    hn::Vec<D> c, q, p;        ///< X/s, Y/s, 1 + c
    hn::Vec<D> e_l, e_t;       ///< exp(-nu (s + X)), exp(-(s + X))
    hn::Vec<D> ratio_less_one; ///< e_t/e_l - 1
};

template<TableShape shape, std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void BearingsOf(D d, const V (&X)[n], const V (&Y)[n], const Radial<D>* const (&at)[n],
                           const LaneMedium<D>& m, Bearing<D> (&result)[n]) {
    V exponent[2 * n];
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        // w = s + X, behind the rod by Y^2/(s - X)
        const V far = hn::Add(at[i]->s, hn::Abs(X[i])), near = hn::Div(hn::Mul(Y[i], Y[i]), far);
        const V w = IfSigned(d, X[i], near, far);
        result[i].c = hn::Mul(X[i], at[i]->inverse);
        result[i].q = hn::Mul(Y[i], at[i]->inverse);
        result[i].p = hn::Mul(w, at[i]->inverse);
        exponent[2 * i] = hn::Mul(m.nu, w);
        exponent[2 * i + 1] = hn::Mul(m.delta, w);
    }
    Exponential<D> e[2 * n];
    ExpMinus<exponential_terms(shape)>(d, exponent, e);
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        result[i].e_l = e[2 * i].value;
        result[i].e_t = hn::Mul(e[2 * i].value, e[2 * i + 1].value);
        result[i].ratio_less_one = e[2 * i + 1].less_one;
    }
}

/// The field at a point from its parts.
template<bool polar, class D, class V = hn::Vec<D>>
HWY_INLINE WakeLanes<D> WakeFrom(D d, const Bearing<D>& b, const Radial<D>& at, const LaneMedium<D>& m) {
    const V one = hn::Set(d, hn::TFromD<D>{1});
    const V &c = b.c, &q = b.q, &p = b.p, &e_l = b.e_l, &e_t = b.e_t;
    const ScaledBessel<D>&t = at.shear, &l = at.longitudinal;
    const V square = hn::Mul(at.inverse, at.inverse), f_l = hn::Mul(e_l, square), f_t = hn::Mul(e_t, square);
    const V core = hn::Mul(f_l, Fma(d, b.ratio_less_one, t.zk1, hn::Sub(t.zk1_less, l.zk1_less)));
    const V m_l = hn::Mul(f_l, l.zk1), plain = Fms(d, f_t, t.zk1, m_l); // m_l = M_L/s^2
    const V n = hn::IfThenElse(hn::Lt(at.s, one), core, plain);
    const V t0 = hn::Mul(e_t, t.k0);
    const V l0 = hn::Mul(hn::Mul(e_l, hn::Mul(m.nu, m.nu)), l.k0);       // nu^2 e_L k0_L
    const V ld = hn::Mul(hn::Mul(e_l, m.nu), hn::Mul(at.inverse, l.zd)); // nu^2 e_L (k1_L - k0_L)
    const V l1 = hn::Add(l0, ld), across = Fma(d, p, l0, ld);
    const V h = hn::Mul(hn::Sub(q, c), hn::Add(q, c)), qq = hn::Mul(q, q), cq2 = hn::Mul(hn::Add(c, c), q);
    WakeLanes<D> wake; // n, which comes last, goes in last
    wake.trace = Fnma(d, p, l1, ld);
    wake.yy = Fma(d, h, n, hn::Mul(qq, hn::Sub(t0, l0)));
    wake.shear = Fma(d, cq2, n, hn::Mul(q, Fms(d, c, t0, across)));
    wake.laplacian_x = wake.laplacian_y = wake.gradient_x = wake.gradient_y = hn::Zero(d);
    if constexpr (polar) {
        // G_T,YY + nu G_L,XX and nu G_L,XY - G_T,XY; (1 + c^2) k0 + 2 c k1 = p^2 k0 + 2 c (k1 - k0)
        const V l_xx = hn::Mul(m.nu, Fma(d, hn::Mul(p, p), l0, hn::Mul(hn::Add(c, c), ld)));
        const V l_xy = hn::Mul(hn::Mul(m.nu, q), across);
        const V both = Fma(d, m.delta, m_l, n);
        const V t_xy = hn::Mul(q, Fma(d, p, t0, hn::Mul(hn::Mul(e_t, at.inverse), t.zd)));
        wake.laplacian_x = hn::Add(Fma(d, qq, t0, hn::Mul(h, both)), l_xx);
        wake.laplacian_y = hn::Sub(hn::Sub(l_xy, t_xy), hn::Mul(cq2, both));
        wake.gradient_x = Fnma(d, h, hn::Mul(m.nu, m_l), l_xx);
        wake.gradient_y = Fma(d, cq2, hn::Mul(m.nu, m_l), l_xy);
    }
    return wake;
}

/// The field at n points (X, Y), lengths in units of 1/c_shear; at[i] is that of sqrt(X^2 + Y^2).
template<bool polar, TableShape shape = full_shape, std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void WakeAt(D d, const V (&X)[n], const V (&Y)[n], const Radial<D>* const (&at)[n],
                       const LaneMedium<D>& m, WakeLanes<D> (&wake)[n]) {
    Bearing<D> bearing[n];
    BearingsOf<shape>(d, X, Y, at, m, bearing);
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i)
        wake[i] = WakeFrom<polar>(d, bearing[i], *at[i], m);
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
