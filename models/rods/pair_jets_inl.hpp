// Turning rates of a pair and their derivatives, a state a lane (include after foreach_target.h).
//
// With w+ = X + i Y, w- its conjugate (lengths in 2 xi) and d = d/dw-, every derivative of a potential is a
// sum of Bessel functions (docs/numerics.md, section 4):
//
//   d^j G_a = (-a/2)^j e^(-a X) sum_m C(j,m) e^(i m theta) K_m(a s),   d+ d G = -(a/2)(d+ + d) G

#if defined(RODWAKE_RODS_PAIR_JETS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_RODS_PAIR_JETS_INL
#undef RODWAKE_RODS_PAIR_JETS_INL
#else
#define RODWAKE_RODS_PAIR_JETS_INL
#endif

#include "elastic/wake_kernel.hpp"
#include "pair_rates_inl.hpp"

#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace rodwake::rods::HWY_NAMESPACE {

using elastic::HWY_NAMESPACE::Bearing;
using elastic::HWY_NAMESPACE::BearingsOf;
using elastic::HWY_NAMESPACE::SineCosine;

struct ComplexLanes {
    V re, im;
};

HWY_INLINE ComplexLanes Plus(ComplexLanes a, ComplexLanes b) {
    return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)};
}
HWY_INLINE ComplexLanes Minus(ComplexLanes a, ComplexLanes b) {
    return {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)};
}
HWY_INLINE ComplexLanes Scaled(V c, ComplexLanes a) { return {hn::Mul(c, a.re), hn::Mul(c, a.im)}; }
HWY_INLINE ComplexLanes Conjugate(ComplexLanes a) { return {a.re, hn::Neg(a.im)}; }
HWY_INLINE ComplexLanes Times(ComplexLanes a, ComplexLanes b) {
    const Lanes d;
    return {Fms(d, a.re, b.re, hn::Mul(a.im, b.im)), Fma(d, a.re, b.im, hn::Mul(a.im, b.re))};
}

/// Of one potential: d, d^2, d^3, d+ d and d+ d^2.
struct Ladder {
    ComplexLanes one, two, three;
    V mixed;
    ComplexLanes mixed_two;
};

HWY_INLINE Ladder LadderOf(V a, V decay, const elastic::HWY_NAMESPACE::ScaledBessel<Lanes>& k, V inverse_z,
                           ComplexLanes u) {
    const Lanes d;
    const V b = hn::Mul(hn::Set(d, -0.5), a);
    const V g0 = hn::Mul(decay, k.k0), g1 = hn::Mul(decay, hn::Mul(k.zk1, inverse_z));
    const V g2 = Fma(d, hn::Set(d, 2.0), hn::Mul(g1, inverse_z), g0),
            g3 = Fma(d, hn::Set(d, 4.0), hn::Mul(g2, inverse_z), g1);
    const ComplexLanes u2 = Times(u, u), u3 = Times(u2, u);
    const auto real = [&](V v) HWY_ATTR { return ComplexLanes{v, hn::Zero(d)}; };
    const auto times = [&](double c, V g) HWY_ATTR { return hn::Mul(hn::Set(d, c), g); };
    Ladder l;
    l.one = Scaled(b, Plus(real(g0), Scaled(g1, u)));
    const V b2 = hn::Mul(b, b);
    l.two = Scaled(b2, Plus(Plus(real(g0), Scaled(times(2.0, g1), u)), Scaled(g2, u2)));
    l.three = Scaled(hn::Mul(b2, b), Plus(Plus(real(g0), Scaled(times(3.0, g1), u)),
                                          Plus(Scaled(times(3.0, g2), u2), Scaled(g3, u3))));
    l.mixed = hn::Mul(hn::Add(b, b), l.one.re);
    l.mixed_two = Scaled(b, Plus(real(l.mixed), l.two));
    return l;
}

/// A quantity with its derivatives by w- and w+.
struct Drive {
    ComplexLanes value, minus, plus;
};

HWY_INLINE Drive Combined(V c, const Drive& a, V e, const Drive& b) {
    return {Plus(Scaled(c, a.value), Scaled(e, b.value)), Plus(Scaled(c, a.minus), Scaled(e, b.minus)),
            Plus(Scaled(c, a.plus), Scaled(e, b.plus))};
}

/// (eps_xx - eps_yy)/2 + i eps_xy, over c_T/(2 pi).
HWY_INLINE Drive ShearOf(const Ladder& t, const Ladder& l) {
    const Lanes d;
    const ComplexLanes mixed{t.mixed, hn::Zero(d)};
    return {Plus(t.one, Minus(t.two, l.two)), Plus(t.two, Minus(t.three, l.three)),
            Plus(mixed, Minus(t.mixed_two, l.mixed_two))};
}

/// grad div u and lap u as complex numbers, over c_T^2/pi.
HWY_INLINE Drive GradientOf(const Ladder& l, V nu) {
    const Lanes d;
    const ComplexLanes mixed{l.mixed, hn::Zero(d)};
    return {Scaled(nu, Plus(l.two, mixed)), Scaled(nu, Plus(l.three, l.mixed_two)),
            Scaled(nu, Plus(l.mixed_two, Conjugate(l.mixed_two)))};
}
HWY_INLINE Drive LaplacianOf(const Ladder& t, const Drive& gradient) {
    const Lanes d;
    const ComplexLanes mixed{t.mixed, hn::Zero(d)};
    return {Plus(gradient.value, Minus(mixed, t.two)), Plus(gradient.minus, Minus(t.mixed_two, t.three)),
            Plus(gradient.plus, Minus(Conjugate(t.mixed_two), t.mixed_two))};
}

/// A rate in the source's frame: itself, by X, Y (in 2 xi) and by the angle between the headings.
struct FrameRate {
    V value, by_x, by_y, by_phi;
};

/// Im(drive f) for f = exp(-i m phi).
HWY_INLINE FrameRate RateOf(const Drive& drive, ComplexLanes f, double m) {
    const Lanes d;
    const ComplexLanes value = Times(drive.value, f);
    const ComplexLanes x = Times(Plus(drive.plus, drive.minus), f),
                       y = Times(Minus(drive.plus, drive.minus), f);
    return {value.im, x.im, y.re,
            hn::Mul(hn::Set(d, -m), value.re)}; // i y: its imaginary part is y's real one
}

template<bool polar>
HWY_INLINE FrameRate RateAt(const Bearing<Lanes>& bearing, const Radial<Lanes>& radial, V cosine, V sine,
                            const PairConstants& c) {
    const Lanes d;
    const ComplexLanes u{bearing.c, bearing.q};
    const Ladder t = LadderOf(hn::Set(d, 1.0), bearing.e_t, radial.shear, radial.inverse, u);
    const Ladder l = LadderOf(c.medium.nu, bearing.e_l, radial.longitudinal,
                              hn::Mul(radial.inverse, c.medium.inverse_nu), u);
    const ComplexLanes f{cosine, hn::Neg(sine)};
    Drive shear = ShearOf(t, l);
    shear = {Scaled(c.kappa, shear.value), Scaled(c.kappa, shear.minus), Scaled(c.kappa, shear.plus)};
    FrameRate rate = RateOf(shear, Times(f, f), 2.0);
    if constexpr (polar) {
        const Drive gradient = GradientOf(l, c.medium.nu);
        const FrameRate more =
            RateOf(Combined(c.gamma1, LaplacianOf(t, gradient), c.gamma2, gradient), f, 1.0);
        rate = {hn::Add(rate.value, more.value), hn::Add(rate.by_x, more.by_x), hn::Add(rate.by_y, more.by_y),
                hn::Add(rate.by_phi, more.by_phi)};
    }
    return rate;
}

/// Rates of turn of both rods, by x, y (of R_0 - R_1) and both headings.
struct Jets {
    SineCosine<Lanes> n[2];
    V rate[2], by[2][4];
    M good;
};

/// `sign` * (X, Y) is where the rod is in the frame of a source of direction n.
template<bool polar>
HWY_INLINE Jets JetsAt(const Relative& at, const PairConstants& c) {
    const Lanes d;
    const Sight seen = SightOf(at, c);
    const auto& [n, radial, X, Y, cosine, sine, good] = seen;
    Bearing<Lanes> bearing[2];
    const Radial<Lanes>* const both[2] = {&radial[0], &radial[0]};
    BearingsOf<elastic::full_shape>(d, X, Y, both, c.medium, bearing);
    Jets jets{{n[0], n[1]}, {}, {}, good};
    RODWAKE_UNROLL
    for (std::size_t rod = 0; rod < 2; ++rod) {
        const FrameRate r =
            RateAt<polar>(bearing[rod], radial[0], cosine, rod == 0 ? sine : hn::Neg(sine), c);
        const SineCosine<Lanes>& frame = n[1 - rod];
        const V unit = rod == 0 ? c.medium.c_shear : hn::Neg(c.medium.c_shear);
        V(&by)[4] = jets.by[rod];
        jets.rate[rod] = r.value;
        by[0] = hn::Mul(unit, Fms(d, frame.cosine, r.by_x, hn::Mul(frame.sine, r.by_y)));
        by[1] = hn::Mul(unit, Fma(d, frame.sine, r.by_x, hn::Mul(frame.cosine, r.by_y)));
        by[2 + rod] = r.by_phi;
        by[3 - rod] = hn::Sub(Fms(d, Y[rod], r.by_x, hn::Mul(X[rod], r.by_y)), r.by_phi);
    }
    return jets;
}

inline PairConstants ConstantsOf(const elastic::Medium& medium, const Couplings& couplings) {
    const Lanes d;
    const auto m = elastic::KernelInternals::constants(elastic::Field(medium));
    const auto& [kappa, gamma1, gamma2] = couplings;
    const double unit = 0.5 * std::numbers::inv_pi * m.c_shear, polar_unit = 2.0 * unit * m.c_shear;
    return {elastic::bessel_table().rows(),
            {hn::Set(d, m.c_shear), hn::Set(d, m.nu), hn::Set(d, m.delta), hn::Set(d, m.inverse_nu)},
            hn::Set(d, unit * kappa),
            hn::Set(d, polar_unit * gamma1),
            hn::Set(d, polar_unit * gamma2)};
}

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
