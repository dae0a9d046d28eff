// Compiled once for each instruction set (foreach_target includes this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "turning_bound.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "turning_bound_inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace rodwake::rods::HWY_NAMESPACE {

TurningBound::Value BoundAt(const elastic::Medium& medium, const Couplings& couplings, double distance,
                            double ahead, double width) {
    const double unit = 0.5 / medium.xi;
    const V r = Number(unit * distance), w = Number(unit * ahead), nu = Number(medium.nu());
    const Around around = AroundOf(r, {w, w}, Number(width), nu);
    const TurningBounds bounds = TurningBoundsOf(around, 0, BoundWeightsOf(medium, couplings), nu);
    return {hn::GetLane(bounds.rate), hn::GetLane(bounds.parts)};
}

double WidthAt(double unit, double distance, double ahead) {
    return hn::GetLane(SuitableWidth(Number(unit * distance), Number(unit * ahead)));
}

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::rods {

HWY_EXPORT(BoundAt);
HWY_EXPORT(WidthAt);

TurningBound::Value TurningBound::at(double distance, double ahead, double width) const {
    return HWY_DYNAMIC_DISPATCH(BoundAt)(medium_, couplings_, distance, ahead, width);
}

double TurningBound::suitable_width(double distance, double ahead) const {
    return HWY_DYNAMIC_DISPATCH(WidthAt)(0.5 / medium_.xi, distance, ahead);
}

} // namespace rodwake::rods
#endif
