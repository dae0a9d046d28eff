// Right-hand side of many pairs, a pair a lane (include after foreach_target.h).

#if defined(RODWAKE_RODS_PAIR_RATES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_RODS_PAIR_RATES_INL
#undef RODWAKE_RODS_PAIR_RATES_INL
#else
#define RODWAKE_RODS_PAIR_RATES_INL
#endif

#include "elastic/kernel_inl.hpp"
#include "pair_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace rodwake::rods::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using elastic::HWY_NAMESPACE::Fma;
using elastic::HWY_NAMESPACE::Fms;
using elastic::HWY_NAMESPACE::Fnma;
using elastic::HWY_NAMESPACE::LaneMedium;
using elastic::HWY_NAMESPACE::Radial;
using elastic::HWY_NAMESPACE::RadialAt;
using elastic::HWY_NAMESPACE::SinCos;
using elastic::HWY_NAMESPACE::WakeAt;
using elastic::HWY_NAMESPACE::WakeLanes;

using Lanes = hn::CappedTag<double, most_lanes>;
using V = hn::Vec<Lanes>;
using M = hn::Mask<Lanes>;
constexpr std::size_t lane_count = hn::MaxLanes(Lanes());

/// What the lanes do not change in a step.
struct PairConstants {
    const double* table;
    LaneMedium<Lanes> medium;
    V kappa, gamma1, gamma2;
};

/// Where the torque comes from: R_0 - R_1 and both headings.
struct Relative {
    V x, y, heading[2];
};

/// Derivatives of the six coordinates.
struct Rates {
    V of[6];
    V apart[2]; ///< of R_0 - R_1
    M in_range;
};

/// Cosine and sine of an angle and of its double.
struct Angle {
    V cosine, sine, cos2, sin2;
};

HWY_INLINE Angle Negative(const Angle& angle) {
    return {angle.cosine, hn::Neg(angle.sine), angle.cos2, hn::Neg(angle.sin2)};
}

/// Rate of turn in a wake, at this angle to its rod.
template<bool polar>
HWY_INLINE V Torque(const WakeLanes<Lanes>& wake, const Angle& angle, const PairConstants& c) {
    const Lanes d;
    V rate =
        hn::Mul(c.kappa, Fma(d, wake.shear, angle.cos2, hn::Mul(hn::Sub(wake.yy, wake.trace), angle.sin2)));
    if constexpr (polar) {
        const V x = Fma(d, c.gamma1, wake.laplacian_x, hn::Mul(c.gamma2, wake.gradient_x));
        const V y = Fma(d, c.gamma1, wake.laplacian_y, hn::Mul(c.gamma2, wake.gradient_y));
        rate = hn::Add(rate, Fms(d, angle.cosine, y, hn::Mul(angle.sine, x)));
    }
    return rate;
}

/// How two rods see each other: rod 0 as rod 1 does, and rod 1 as rod 0 does, lengths in 2 xi.
struct Sight {
    elastic::HWY_NAMESPACE::SineCosine<Lanes> n[2];
    Radial<Lanes> radial[1];
    V X[2], Y[2];
    V cosine, sine; ///< of theta_0 - theta_1
    M good;         ///< within the range of the kernels
};

HWY_INLINE Sight SightOf(const Relative& at, const PairConstants& c) {
    const Lanes d;
    Sight s;
    SinCos(d, at.heading, s.n);
    const auto& n = s.n;
    const V x = hn::Mul(at.x, c.medium.c_shear), y = hn::Mul(at.y, c.medium.c_shear);
    const V distance[1] = {hn::Sqrt(Fma(d, x, x, hn::Mul(y, y)))};
    RadialAt(d, c.table, distance, c.medium, s.radial);
    s.X[0] = Fma(d, n[1].cosine, x, hn::Mul(n[1].sine, y));
    s.X[1] = hn::Neg(Fma(d, n[0].cosine, x, hn::Mul(n[0].sine, y)));
    s.Y[0] = Fms(d, n[1].cosine, y, hn::Mul(n[1].sine, x));
    s.Y[1] = Fnma(d, n[0].cosine, y, hn::Mul(n[0].sine, x));
    s.cosine = Fma(d, n[0].cosine, n[1].cosine, hn::Mul(n[0].sine, n[1].sine));
    s.sine = Fms(d, n[0].sine, n[1].cosine, hn::Mul(n[0].cosine, n[1].sine));
    const V largest = hn::Set(d, elastic::HWY_NAMESPACE::largest_angle);
    const M small = hn::And(hn::Lt(hn::Abs(at.heading[0]), largest), hn::Lt(hn::Abs(at.heading[1]), largest));
    s.good = hn::And(small, s.radial[0].in_range);
    return s;
}

/// Not inlined: seven copies would cost more to load and to compile than the calls do.
template<bool polar>
HWY_NOINLINE Rates RatesAt(const Relative& at, const PairConstants& c) {
    const Lanes d;
    const Sight s = SightOf(at, c);
    WakeLanes<Lanes> wake[2];
    WakeAt<polar>(d, s.X, s.Y, {&s.radial[0], &s.radial[0]}, c.medium, wake);
    const Angle angle{s.cosine, s.sine, Fms(d, s.cosine, s.cosine, hn::Mul(s.sine, s.sine)),
                      hn::Mul(hn::Add(s.sine, s.sine), s.cosine)};
    const V turn0 = Torque<polar>(wake[0], angle, c), turn1 = Torque<polar>(wake[1], Negative(angle), c);
    return {{s.n[0].cosine, s.n[0].sine, turn0, s.n[1].cosine, s.n[1].sine, turn1},
            {hn::Sub(s.n[0].cosine, s.n[1].cosine), hn::Sub(s.n[0].sine, s.n[1].sine)},
            s.good};
}

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
