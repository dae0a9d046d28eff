// How large turning rates can be about a place (turning_bound.hpp), a place a lane (include after
// foreach_target.h). Lengths in 2 xi.

#if defined(RODWAKE_RODS_TURNING_BOUND_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_RODS_TURNING_BOUND_INL
#undef RODWAKE_RODS_TURNING_BOUND_INL
#else
#define RODWAKE_RODS_TURNING_BOUND_INL
#endif

#include "pair_rates_inl.hpp"
#include "turning_bound.hpp"

#include <cmath>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace rodwake::rods::HWY_NAMESPACE {

using elastic::HWY_NAMESPACE::ExpMinus;
using elastic::HWY_NAMESPACE::Exponential;

HWY_INLINE V Number(double value) { return hn::Set(Lanes(), value); }

/// Bounds of e^z K_n(z): K0 < K_(1/2), K1 < min(1/z, K_(3/2)), and K2 = K0 + 2 K1/z.
struct ScaledBounds {
    V k0, k1, k2;
};

HWY_INLINE ScaledBounds ScaledBoundsOf(V z) {
    const Lanes d;
    const V one = Number(1.0), inverse = hn::Div(one, z);
    const V half = hn::Sqrt(hn::Mul(Number(0.5 * std::numbers::pi), inverse)),
            wide = Fma(d, half, inverse, half);
    const V growth = Fma(d, Fma(d, Number(std::numbers::e - 2.0), z, one), z, one); // e^z at most, below 1
    const V k1 = hn::IfThenElse(hn::Lt(z, one), hn::Min(hn::Mul(growth, inverse), wide), wide);
    return {half, k1, Fma(d, hn::Add(k1, k1), inverse, half)};
}

/// |d G|, |d^2 G|, and the part of d^2 G that does not cancel near the rod; but for what decays.
struct LadderBounds {
    V one, two, rest;
};

HWY_INLINE LadderBounds LadderBoundsOf(V a, const ScaledBounds& k, V q) {
    const Lanes d;
    const V b = hn::Mul(Number(0.5), a), b2 = hn::Mul(b, b), qk1 = hn::Mul(q, k.k1),
            twice = hn::Add(qk1, qk1);
    const V q2 = hn::Mul(q, q), even = hn::Add(k.k0, twice);
    return {hn::Mul(b, hn::Add(k.k0, qk1)), hn::Mul(b2, Fma(d, q2, k.k2, even)),
            hn::Mul(b2, Fma(d, q2, k.k0, even))};
}

/// For both rods of a pair at this distance, where s + X is `ahead`, within a relative width of the place.
struct Around {
    LadderBounds t, l;
    V core; ///< |H_T - H_L|, H_a = e^(-a X) a s K1(a s), over |s|^2/2; but for what decays
    V decay_t[2], decay_l[2];
    V phase;
};

HWY_INLINE Around AroundOf(V r, const V (&ahead)[2], V k, V nu) {
    const Lanes d;
    const V one = Number(1.0), less = hn::Sub(one, k), more = hn::Add(one, k);
    const V least = hn::Mul(hn::Mul(r, less), hn::Sqrt(hn::Mul(less, more))); // Re s
    const V s = hn::Mul(r, more), turn2 = hn::Div(more, less), turn = hn::Sqrt(turn2);
    const V sigma = hn::Mul(hn::Mul(Number(2.0), hn::Sqrt(r)), hn::Sub(one, hn::Sqrt(less)));
    Around a;
    a.phase = more;
    V exponent[4];
    RODWAKE_UNROLL
    for (std::size_t rod = 0; rod < 2; ++rod) {
        const V depth =
            hn::Sub(ahead[rod],
                    hn::Mul(sigma, Fma(d, Number(0.5), sigma, hn::Sqrt(hn::Add(ahead[rod], ahead[rod])))));
        exponent[rod] = hn::Max(depth, Number(-600.0));
        exponent[2 + rod] = hn::Mul(nu, exponent[rod]);
    }
    Exponential<Lanes> e[4];
    ExpMinus(d, exponent, e);
    RODWAKE_UNROLL
    for (std::size_t rod = 0; rod < 2; ++rod) {
        a.decay_t[rod] = e[rod].value;
        a.decay_l[rod] = e[2 + rod].value;
    }
    const ScaledBounds t = ScaledBoundsOf(least), l = ScaledBoundsOf(hn::Mul(nu, least));
    a.t = LadderBoundsOf(one, t, turn);
    a.l = LadderBoundsOf(nu, l, turn);
    const V stretch = hn::Div(s, least),
            change = hn::Mul(hn::Mul(hn::Sub(one, nu), s), // |s| over its least real part
                             hn::Mul(stretch, hn::Mul(least, hn::Add(t.k0, t.k1))));
    a.core = hn::Div(hn::Mul(hn::Mul(Number(0.5), turn2), change), hn::Mul(least, least));
    return a;
}

/// Of couplings, with their units.
struct BoundWeights {
    V kappa, laplacian, gradient;
};

inline BoundWeights BoundWeightsOf(const elastic::Medium& medium, const Couplings& couplings) {
    const auto& [kappa, gamma1, gamma2] = couplings;
    const double c = 0.5 / medium.xi, unit = c * std::numbers::inv_pi;
    return {Number(0.5 * unit * std::abs(kappa)), Number(unit * c * std::abs(gamma1)),
            Number(unit * c * (std::abs(gamma1) + std::abs(gamma2)))};
}

/// Where exp(-a depth)/width^n is least: bounds of derivatives and remainders go by it.
HWY_INLINE V SuitableWidth(V r, V ahead) {
    constexpr double widest = 0.4, power = 5.0;
    const V w2 = hn::Add(ahead, ahead);
    const V way = hn::Sub(hn::Sqrt(hn::Add(w2, Number(4.0 * power))), hn::Sqrt(w2));
    return hn::Min(Number(widest), hn::Div(hn::Mul(Number(0.5), way), hn::Sqrt(r)));
}

struct TurningBounds {
    V rate, parts;
};

HWY_INLINE TurningBounds TurningBoundsOf(const Around& a, std::size_t rod, const BoundWeights& w, V nu) {
    const Lanes d;
    const V one = hn::Mul(a.decay_t[rod], a.t.one);
    const V two_t = hn::Mul(a.decay_t[rod], a.t.two), two_l = hn::Mul(a.decay_l[rod], a.l.two);
    const V plain = hn::Add(two_t, two_l);
    const V near =
        Fma(d, a.decay_t[rod], a.t.rest,
            Fma(d, a.decay_l[rod], a.l.rest, hn::Mul(a.core, hn::Max(a.decay_t[rod], a.decay_l[rod]))));
    const V polar = hn::Mul(
        a.phase, Fma(d, w.laplacian, hn::Add(one, two_t),
                     hn::Mul(hn::Mul(w.gradient, nu), Fma(d, hn::Mul(nu, a.decay_l[rod]), a.l.one, two_l))));
    const V apolar = hn::Mul(w.kappa, hn::Mul(a.phase, a.phase));
    return {Fma(d, apolar, hn::Add(one, hn::Min(plain, near)), polar),
            Fma(d, apolar, hn::Add(one, plain), polar)};
}

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
