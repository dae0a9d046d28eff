// One point by the kernels' algorithm. Compiled once for each instruction set (foreach_target includes this
// file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "field_lane.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "elastic/field_lane.hpp"
#include "elastic/kernel_inl.hpp"

#include <cmath>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

using Lane = hn::CappedTag<double, 1>;
using V = hn::Vec<Lane>;

/// Where a point is, in units of 1/c_shear; s is its distance.
struct Point {
    double X, Y, s;
};

LaneMedium<Lane> MediumOf(const Constants& medium) {
    const Lane d;
    return {hn::Set(d, medium.c_shear), hn::Set(d, medium.nu), hn::Set(d, medium.delta),
            hn::Set(d, medium.inverse_nu)};
}

#if HWY_TARGET == HWY_SCALAR
template<bool polar>
HWY_INLINE Wake<Lane> WakeOf(const Constants& medium, const Point& at) {
    const Lane d;
    const LaneMedium<Lane> m = MediumOf(medium);
    Radial<Lane> radial[1];
    RadialAt(d, bessel_table().rows(), {hn::Set(d, at.s)}, m, radial);
    Wake<Lane> wake[1];
    WakeAt<polar>(d, {hn::Set(d, at.X)}, {hn::Set(d, at.Y)}, {&radial[0]}, m, wake);
    return wake[0];
}
#else
using Both = hn::CappedTag<double, 2>; ///< of the shear and of the longitudinal potential
using V2 = hn::Vec<Both>;

HWY_INLINE V2 Two(double lower, double upper) {
    return hn::Combine(Both(), hn::Set(Lane(), upper), hn::Set(Lane(), lower));
}
HWY_INLINE V Lower(V2 v) { return hn::LowerHalf(Lane(), v); }
HWY_INLINE V Upper(V2 v) { return hn::UpperHalf(Lane(), v); }

/// RadialAt, with both potentials in one vector: half the instructions, the same bits.
HWY_INLINE Radial<Lane> RadialOf(const Constants& medium, double s, const double* table) {
    const Both d;
    const double inverse = 1.0 / s;
    ScaledBessel<Both> k[1];
    BesselAt<full_shape>(d, table, {Two(s, s * medium.nu)}, {Two(inverse, inverse * medium.inverse_nu)}, k);
    return {hn::Set(Lane(), s),
            hn::Set(Lane(), inverse),
            {Lower(k[0].k0), Lower(k[0].zk1), Lower(k[0].zk1_less), Lower(k[0].zd)},
            {Upper(k[0].k0), Upper(k[0].zk1), Upper(k[0].zk1_less), Upper(k[0].zd)},
            hn::FirstN(Lane(), 1)};
}

/// BearingsOf, likewise.
HWY_INLINE Bearing<Lane> BearingOf(const Constants& medium, const Point& at, double inverse) {
    const Lane d;
    const double far = at.s + std::abs(at.X), w = at.X >= 0.0 ? far : at.Y * at.Y / far;
    Exponential<Both> e[1];
    ExpMinus(Both(), {Two(medium.nu * w, medium.delta * w)}, e);
    const V e_l = Lower(e[0].value);
    return {hn::Set(d, at.X * inverse),      hn::Set(d, at.Y * inverse), hn::Set(d, w * inverse), e_l,
            hn::Mul(e_l, Upper(e[0].value)), Upper(e[0].less_one)};
}

template<bool polar>
HWY_INLINE Wake<Lane> WakeOf(const Constants& medium, const Point& at) {
    const Radial<Lane> radial = RadialOf(medium, at.s, bessel_table().rows());
    const Bearing<Lane> bearing = BearingOf(medium, at, hn::GetLane(radial.inverse));
    return WakeFrom<polar>(Lane(), bearing, radial, MediumOf(medium));
}
#endif

template<bool polar>
HWY_INLINE void FieldInLane(const Constants& medium, const Point& at, LaneField& field) {
    const Wake<Lane> wake = WakeOf<polar>(medium, at);
    const double unit = 0.5 * std::numbers::inv_pi * medium.c_shear, half = 0.5 * unit;
    const double trace = hn::GetLane(wake.trace), yy = hn::GetLane(wake.yy);
    field.strain = {unit * trace - half * yy, half * hn::GetLane(wake.shear), half * yy};
    if constexpr (polar) {
        const double third = unit * medium.c_shear;
        field.laplacian = {third * hn::GetLane(wake.laplacian_x), third * hn::GetLane(wake.laplacian_y)};
        field.gradient_of_trace = {third * hn::GetLane(wake.gradient_x),
                                   third * hn::GetLane(wake.gradient_y)};
    }
}

void StrainInLane(const Constants& medium, double X, double Y, double s, LaneField& field) {
    FieldInLane<false>(medium, {X, Y, s}, field);
}

void PolarInLane(const Constants& medium, double X, double Y, double s, LaneField& field) {
    FieldInLane<true>(medium, {X, Y, s}, field);
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::elastic {

HWY_EXPORT(StrainInLane);
HWY_EXPORT(PolarInLane);

namespace {

/// Where the route is as accurate as the closed form. Outside, parts cancel: at large eta near the rod, of
/// eps_yy on the axis as eta -> 0, of lap U near r = eta xi on the axis ahead, of grad div U far behind; and
/// exponents want more digits.
bool suits(const Constants& medium, double X, double Y, double s) {
    constexpr double least_nu = 1.0 / 11.0, largest_nu = 1.0 / 1.1;
    return medium.nu <= largest_nu && medium.nu >= least_nu && s >= 0x1p-20 && s <= 64.0 &&
           medium.nu * (s + X) <= 16.0 && 8.0 * std::abs(Y) >= X;
}

} // namespace

bool lane_field(const Constants& medium, double x, double y, bool polar, LaneField& field) {
    const double X = x * medium.c_shear, Y = y * medium.c_shear, s = std::sqrt(X * X + Y * Y);
    if (!suits(medium, X, Y, s))
        return false;
    if (polar)
        HWY_DYNAMIC_DISPATCH(PolarInLane)(medium, X, Y, s, field);
    else
        HWY_DYNAMIC_DISPATCH(StrainInLane)(medium, X, Y, s, field);
    return true;
}

} // namespace rodwake::elastic
#endif
