// Compiled once for each instruction set (foreach_target includes this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "touches.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "touches.hpp"

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace rodwake::granular::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, Touches::most>;
using V = hn::Vec<Lanes>;
using M = hn::Mask<Lanes>;

V All(double value) { return hn::Set(Lanes(), value); }

/// Distances of beads in free flight from their plates as polynomials in the time before the end of the step.
struct PlateApproach {
    V c[8]; ///< of before^n
    V d[8]; ///< of before^(n - 1) in the derivative

    // In pairs of terms, which do not wait for each other.
    HWY_INLINE V Gap(V b) const {
        const V b2 = hn::Mul(b, b), b4 = hn::Mul(b2, b2);
        const auto pair = [&](int n) HWY_ATTR { return hn::Add(c[n], hn::Mul(c[n + 1], b)); };
        return hn::Add(hn::Add(pair(0), hn::Mul(pair(2), b2)),
                       hn::Mul(hn::Add(pair(4), hn::Mul(pair(6), b2)), b4));
    }
    /// -d gap/d before: negative when approaching.
    HWY_INLINE V Opening(V b) const {
        const V b2 = hn::Mul(b, b), b4 = hn::Mul(b2, b2);
        const auto pair = [&](int n) HWY_ATTR { return hn::Add(d[n], hn::Mul(d[n + 1], b)); };
        return hn::Neg(hn::Add(hn::Add(pair(1), hn::Mul(pair(3), b2)),
                               hn::Mul(hn::Add(pair(5), hn::Mul(d[7], b2)), b4)));
    }
};

HWY_INLINE PlateApproach ApproachOf(const PlateStep& step, V radius, V side, M floor, V z, V vz) {
    PlateApproach approach;
    for (std::size_t n = 0; n < 8; ++n)
        approach.c[n] = hn::Mul(hn::Neg(side), All(step.floor.c[n]));
    V* c = approach.c;
    const V height = hn::Sub(z, hn::IfThenElse(floor, hn::Zero(Lanes()), All(step.gap)));
    c[0] = hn::Add(c[0], hn::Sub(hn::Mul(side, height), radius));
    c[1] = hn::Sub(c[1], hn::Mul(side, vz));
    c[2] = hn::Sub(c[2], hn::Div(hn::Mul(side, All(step.gravity)), All(2.0)));
    for (std::size_t n = 1; n < 8; ++n)
        approach.d[n] = hn::Mul(All(static_cast<double>(n)), c[n]);
    return approach;
}

/// Acceleration with which free bodies are pressed against the plates.
HWY_INLINE V Pressing(const PlateStep& step, V side, V before) {
    V floor = hn::Zero(Lanes());
    for (std::size_t n = 8; n-- > 2;)
        floor = hn::Add(hn::Mul(floor, before), All(static_cast<double>(n * (n - 1)) * step.floor.c[n]));
    return hn::Mul(side, hn::Add(All(step.gravity), floor));
}

/// The time since the touch were accelerations constant, where that lies between `within` and `apart`; else
/// their middle.
HWY_INLINE V RoughTime(const PlateApproach& approach, V pressing, V within, V apart) {
    const V depth = hn::Neg(approach.c[0]), speed = approach.c[1];
    const V inside = hn::Sub(hn::Mul(speed, speed), hn::Mul(hn::Mul(All(2.0), pressing), depth));
    const V time = hn::Div(hn::Mul(All(2.0), depth), hn::Add(speed, hn::Sqrt(inside)));
    const M sound =
        hn::And(hn::Ge(inside, hn::Zero(Lanes())), hn::And(hn::Gt(time, within), hn::Lt(time, apart)));
    return hn::IfThenElse(sound, time, hn::Div(hn::Add(within, apart), All(2.0)));
}

/// As touch_time in bounces.cpp: Newton's method between a time at which a bead is apart from the plate and
/// one at which it is within.
HWY_INLINE V TouchTime(const PlateApproach& approach, V apart, V within, V time, V tolerance, M active) {
    for (int i = 0; i < 60 && !hn::AllFalse(Lanes(), active); ++i) {
        const V here = approach.Gap(time), slope = hn::Neg(approach.Opening(time));
        const M out = hn::Gt(here, hn::Zero(Lanes()));
        apart = hn::IfThenElse(out, time, apart);
        within = hn::IfThenElse(out, within, time);
        const V newton = hn::Sub(time, hn::Div(here, slope));
        const M between =
            hn::And(hn::Ge(newton, hn::Min(apart, within)), hn::Le(newton, hn::Max(apart, within)));
        const V next = hn::IfThenElse(between, newton, hn::Div(hn::Add(apart, within), All(2.0)));
        const M found = hn::Le(hn::Abs(hn::Sub(next, time)), tolerance);
        time = hn::IfThenElse(active, next, time);
        active = hn::AndNot(found, active);
    }
    return time;
}

/// How long before the end of the step beads touched that have flown for `back`.
HWY_INLINE V TimeSinceTouch(const PlateStep& step, const PlateApproach& approach, V side, V back, M inside) {
    // Touching from the start on, or so soon that it makes no hop.
    const V zero = hn::Zero(Lanes()), half = All(2.0);
    const V pressing = hn::Max(Pressing(step, side, back), zero), soon = hn::Mul(All(shortest_hop), back);
    const V opening = approach.Opening(back), little = hn::Mul(pressing, soon);
    const M touching = hn::And(hn::Le(approach.Gap(back), hn::Div(hn::Mul(little, soon), half)),
                               hn::Le(hn::Abs(opening), little));
    // The last time a bead was clear: the start of its flight, or the top of its hop if it leaves the plate.
    const M leaves = hn::And(hn::Gt(opening, zero), hn::Gt(pressing, zero));
    const V top = hn::Max(hn::Sub(back, hn::Div(opening, pressing)), hn::Div(back, half));
    const V apart = hn::IfThenElse(leaves, top, back);
    const V now = hn::Mul(side, All(step.gravity + step.floor.acceleration()));
    const V start = RoughTime(approach, now, zero, apart);
    const V time =
        TouchTime(approach, apart, zero, start, hn::Mul(All(1e-8), back), // what is left is rounding
                  hn::AndNot(touching, inside));
    return hn::IfThenElse(touching, back, time);
}

void FindTouches(const PlateStep& step, std::size_t count, Touches& touches) {
    const Lanes lanes;
    for (std::size_t i = 0; i < count; i += hn::Lanes(lanes)) {
        const V z = hn::Load(lanes, touches.z + i), vz = hn::Load(lanes, touches.vz + i),
                radius = hn::Load(lanes, touches.radius + i);
        const V back = hn::Load(lanes, touches.back + i), zero = hn::Zero(lanes), one = All(1.0);
        const auto gap_now = [&](M floor) HWY_ATTR {
            return ApproachOf(step, radius, hn::IfThenElse(floor, one, hn::Neg(one)), floor, z, vz).c[0];
        };
        // the gap is wider than a bead, so none can be in both
        const M every = hn::Eq(zero, zero), floor = hn::Lt(gap_now(every), zero),
                either = hn::Or(floor, hn::Lt(gap_now(hn::Not(every)), zero));
        const V side = hn::IfThenElse(floor, one, hn::Neg(one));
        PlateApproach approach = ApproachOf(step, radius, side, floor, z, vz);
        approach.c[0] = hn::Add(approach.c[0], hn::Max(hn::Neg(approach.Gap(back)), zero));
        const M inside = hn::And(either, hn::Lt(approach.c[0], zero));
        const V time = TimeSinceTouch(step, approach, side, back, inside);
        hn::Store(hn::IfThenElseZero(inside, side), lanes, touches.side + i);
        hn::Store(hn::Neg(approach.c[0]), lanes, touches.depth + i);
        hn::Store(hn::Neg(approach.Opening(time)), lanes, touches.speed + i);
        hn::Store(time, lanes, touches.back + i);
    }
}

} // namespace rodwake::granular::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::granular {

HWY_EXPORT(FindTouches);

void find_touches(const PlateStep& step, std::size_t count, Touches& touches) {
    for (std::size_t i = count; i < Touches::most; ++i) // in neither plate
        touches.z[i] = touches.vz[i] = touches.radius[i] = touches.back[i] =
            std::numeric_limits<double>::quiet_NaN();
    HWY_DYNAMIC_DISPATCH(FindTouches)(step, count, touches);
}

} // namespace rodwake::granular
#endif
