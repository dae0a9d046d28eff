// Compiled once for each instruction set (foreach_target includes this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pair_rows.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "pair_counts.hpp"

HWY_BEFORE_NAMESPACE();
namespace rodwake::measure::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void FillPairRow(const PairColumns& beads, std::size_t i, std::size_t count, const PeriodicBox& box,
                 double per_bin, std::int32_t* bin, double* order) {
    const hn::CappedTag<double, padding> lanes;
    const hn::Rebind<std::int32_t, decltype(lanes)> whole;
    const auto side_x = hn::Set(lanes, box.x), side_y = hn::Set(lanes, box.y),
               scale = hn::Set(lanes, per_bin);
    const auto xi = hn::Set(lanes, beads.x[i]), yi = hn::Set(lanes, beads.y[i]);
    const auto re = hn::Set(lanes, beads.re[i]), im = hn::Set(lanes, beads.im[i]);
    const auto apart = [&](const double* position, auto from, auto side) { // to the nearest image
        const auto d = hn::Abs(hn::Sub(hn::LoadU(lanes, position), from));
        return hn::Min(d, hn::Sub(side, d));
    };
    for (std::size_t k = 0; k < count; k += hn::Lanes(lanes)) {
        const std::size_t j = i + 1 + k;
        const auto dx = apart(beads.x + j, xi, side_x), dy = apart(beads.y + j, yi, side_y);
        const auto r = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
        hn::StoreU(hn::DemoteTo(whole, hn::Mul(r, scale)), whole, bin + k);
        const auto a = hn::Mul(hn::LoadU(lanes, beads.re + j), re),
                   b = hn::Mul(hn::LoadU(lanes, beads.im + j), im);
        hn::StoreU(hn::Add(a, b), lanes, order + k);
    }
}

} // namespace rodwake::measure::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::measure {

HWY_EXPORT(FillPairRow);

void fill_pair_row(const PairColumns& beads, std::size_t i, std::size_t count, const PeriodicBox& box,
                   double per_bin, std::int32_t* bin, double* order) {
    HWY_DYNAMIC_DISPATCH(FillPairRow)(beads, i, count, box, per_bin, bin, order);
}

} // namespace rodwake::measure
#endif
