// One point by the kernels' algorithm. Compiled once for each instruction set (foreach_target includes this
// file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "field_lane.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "geometry.hpp"
#include "kernel_inl.hpp"

#include <cmath>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

using Lane = hn::CappedTag<double, 1>;
using V = hn::Vec<Lane>;

/// Where a point is, in units of 1/c_shear; s is its distance.
struct ScaledPoint {
    double X, Y, square, s;
};

HWY_INLINE ScaledPoint PointAt(const Constants& medium, double x, double y) {
    const Lane d;
    const V X = hn::Set(d, x * medium.c_shear), Y = hn::Set(d, y * medium.c_shear);
    const V square = Fma(d, X, X, hn::Mul(Y, Y));
    return {hn::GetLane(X), hn::GetLane(Y), hn::GetLane(square), hn::GetLane(hn::Sqrt(square))};
}

/// e^-x known, that of x + correction; the correction is a matter of the last digits.
template<class D>
HWY_INLINE Exponential<D> Corrected(D d, const Exponential<D>& e, hn::Vec<D> correction) {
    return {Fnma(d, correction, e.value, e.value), Fnma(d, correction, e.value, e.less_one)};
}

/// Of nu w and of delta w, nu w <= 16: with lane_reach no exponent comes near its limit.
struct DecayFactors {
    Exponential<Lane> longitudinal, difference;
};

/// Of the shear and of the longitudinal potential.
struct BothBessel {
    ScaledBessel<Lane> shear, longitudinal;
};

/// Of the angle from the heading.
struct LaneDirection {
    V cosine, sine;
};

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE LaneDirection DirectionOf(const ScaledPoint& at, double inverse) {
    return {hn::Set(Lane(), at.X * inverse), hn::Set(Lane(), at.Y * inverse)};
}

HWY_INLINE BothBessel BesselOf(const Constants& medium, double s, double inverse) {
    const Lane d;
    ScaledBessel<Lane> k[2];
    BesselAt<full_shape>(d, medium.bessel_rows, {hn::Set(d, s), hn::Set(d, s * medium.nu)},
                         {hn::Set(d, inverse), hn::Set(d, inverse * medium.inverse_nu)}, k);
    return {k[0], k[1]};
}

HWY_INLINE DecayFactors DecayOf(const Constants& medium, double x, double accurate) {
    const Lane d;
    Exponential<Lane> e[2];
    ExpMinus<exponential_terms(full_shape), false>(
        d, {hn::Set(d, x * medium.nu), hn::Set(d, x * medium.delta)}, e);
    const double correction = accurate - x;
    return {Corrected(d, e[0], hn::Set(d, correction * medium.nu)),
            Corrected(d, e[1], hn::Set(d, correction * medium.delta))};
}
#else
// Both in one vector: half the instructions, the same bits.
using Both = hn::CappedTag<double, 2>;
using V2 = hn::Vec<Both>;

HWY_INLINE V2 Two(double lower, double upper) {
    const Both d;
    return hn::InterleaveLower(d, hn::Set(d, lower), hn::Set(d, upper));
}
HWY_INLINE V Lower(V2 v) { return hn::LowerHalf(Lane(), v); }
HWY_INLINE V Upper(V2 v) { return hn::UpperHalf(Lane(), v); }

HWY_INLINE LaneDirection DirectionOf(const ScaledPoint& at, double inverse) {
    const V2 both = hn::Mul(hn::Set(Both(), inverse), Two(at.X, at.Y));
    return {Lower(both), Upper(both)};
}

HWY_INLINE BothBessel BesselOf(const Constants& medium, double s, double inverse) {
    const Both d;
    ScaledBessel<Both> k[1];
    BesselAt<full_shape>(d, medium.bessel_rows, {hn::Mul(hn::Set(d, s), Two(1.0, medium.nu))},
                         {hn::Mul(hn::Set(d, inverse), Two(1.0, medium.inverse_nu))}, k);
    return {{Lower(k[0].k0), Lower(k[0].zk1), Lower(k[0].zk1_less), Lower(k[0].zd)},
            {Upper(k[0].k0), Upper(k[0].zk1), Upper(k[0].zk1_less), Upper(k[0].zd)}};
}

HWY_INLINE DecayFactors DecayOf(const Constants& medium, double x, double accurate) {
    const Both d;
    const V2 waves = Two(medium.nu, medium.delta);
    Exponential<Both> e[1];
    ExpMinus<exponential_terms(full_shape), false>(d, {hn::Mul(hn::Set(d, x), waves)}, e);
    const Exponential<Both> right = Corrected(d, e[0], hn::Mul(hn::Set(d, accurate - x), waves));
    return {{Lower(right.value), Lower(right.less_one)}, {Upper(right.value), Upper(right.less_one)}};
}
#endif

/// RadialAt, BearingsOf and WakeFrom of one point. What takes long begins early: 1/s beside the root, and
/// behind the rod the exponentials of s + X, which Y^2/(s - X), exact there, corrects. K0 and K1 first:
/// theirs is the longer way.
template<bool polar>
HWY_INLINE WakeLanes<Lane> WakeOf(const Constants& medium, const ScaledPoint& at) {
    const Lane d;
    const double inverse = at.s * (1.0 / at.square), far = at.s + std::abs(at.X), sum = at.s + at.X;
    const V near = hn::Set(d, at.Y * at.Y / far);
    const V w = IfSigned(d, hn::Set(d, at.X), near, hn::Set(d, far));
    const BothBessel k = BesselOf(medium, at.s, inverse);
    const DecayFactors e = DecayOf(medium, sum, hn::GetLane(w));
    const Radial<Lane> radial{hn::Set(d, at.s), hn::Set(d, inverse), k.shear, k.longitudinal,
                              hn::FirstN(d, 1)};
    const LaneDirection towards = DirectionOf(at, inverse);
    const Bearing<Lane> bearing{towards.cosine,
                                towards.sine,
                                hn::Mul(w, radial.inverse),
                                e.longitudinal.value,
                                hn::Mul(e.longitudinal.value, e.difference.value),
                                e.difference.less_one};
    return WakeFrom<polar>(d, bearing, radial,
                           {hn::Set(d, medium.c_shear), hn::Set(d, medium.nu), hn::Set(d, medium.delta),
                            hn::Set(d, medium.inverse_nu)});
}

/// Where the strain is as accurate as by the closed form, beside lane_reach: further exponents want more
/// digits.
HWY_INLINE bool Suits(const Constants& medium, const ScaledPoint& at) {
    return at.s >= 0x1p-20 && at.s <= medium.lane_reach && medium.nu * (at.s + at.X) <= 16.0;
}

HWY_INLINE SymmetricTensor StrainOf(const Constants& medium, const WakeLanes<Lane>& wake) {
    const double unit = 0.5 * std::numbers::inv_pi * medium.c_shear, half = 0.5 * unit;
    const double trace = hn::GetLane(wake.trace), yy = hn::GetLane(wake.yy);
    return {unit * trace - half * yy, half * hn::GetLane(wake.shear), half * yy};
}

bool StrainInLane(const Constants& medium, double x, double y, SymmetricTensor& strain) {
    const ScaledPoint at = PointAt(medium, x, y);
    if (!Suits(medium, at))
        return false;
    strain = StrainOf(medium, WakeOf<false>(medium, at));
    return true;
}

bool PolarInLane(const Constants& medium, double x, double y, FieldValues& field) {
    const ScaledPoint at = PointAt(medium, x, y);
    const bool along_axis = 8.0 * std::abs(at.Y) < at.X; // lap U vanishes near r = eta xi on the axis ahead
    if (along_axis || !Suits(medium, at))
        return false;
    const WakeLanes<Lane> wake = WakeOf<true>(medium, at);
    const double third = 0.5 * std::numbers::inv_pi * medium.c_shear * medium.c_shear;
    field.strain = StrainOf(medium, wake);
    field.laplacian = {third * hn::GetLane(wake.laplacian_x), third * hn::GetLane(wake.laplacian_y)};
    field.gradient_of_trace = {third * hn::GetLane(wake.gradient_x), third * hn::GetLane(wake.gradient_y)};
    return true;
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::elastic {

HWY_EXPORT(StrainInLane);
HWY_EXPORT(PolarInLane);

double lane_reach(const Medium& medium) {
    // parts cancel at large eta near the rod, and in eps_yy on the axis as eta -> 0
    return medium.eta >= 0.1 && medium.eta <= 10.0 ? 64.0 : 0.0;
}

bool lane_strain(const Constants& medium, double x, double y, SymmetricTensor& strain) {
    return HWY_DYNAMIC_DISPATCH(StrainInLane)(medium, x, y, strain);
}

bool lane_strain_and_polar(const Constants& medium, double x, double y, FieldValues& field) {
    return HWY_DYNAMIC_DISPATCH(PolarInLane)(medium, x, y, field);
}

} // namespace rodwake::elastic
#endif
