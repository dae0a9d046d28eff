// Compiled once for each instruction set (foreach_target includes this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "edge_shares.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "edge_shares.hpp"

#include <iterator>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace rodwake::measure::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template<class Lanes, class Vector>
Vector ArcCosine(Lanes lanes, Vector u) {
    const auto t = hn::Sub(hn::Add(u, u), hn::Set(lanes, 1.0));
    auto sum = hn::Set(lanes, arc_cosine_rest[std::size(arc_cosine_rest) - 1]);
    for (std::size_t k = std::size(arc_cosine_rest) - 1; k-- > 0;)
        sum = hn::Add(hn::Mul(sum, t), hn::Set(lanes, arc_cosine_rest[k]));
    return hn::Mul(hn::Sqrt(hn::Sub(hn::Set(lanes, 1.0), u)), sum);
}

template<class Lanes>
void TakeEdge(Lanes lanes, double distance, double low, double high, std::size_t k, double* share) {
    const auto radius = hn::Add(hn::Iota(lanes, static_cast<double>(k)), hn::Set(lanes, 0.5));
    const auto open =
        ArcCosine(lanes, hn::Min(hn::Set(lanes, 1.0), hn::Div(hn::Set(lanes, distance), radius)));
    const auto seen =
        hn::Sub(hn::Min(hn::Set(lanes, high), open), hn::Max(hn::Set(lanes, low), hn::Neg(open)));
    const auto part = hn::Mul(hn::Max(hn::Zero(lanes), seen), hn::Set(lanes, 0.5 / std::numbers::pi));
    hn::StoreU(hn::Sub(hn::LoadU(lanes, share + k), part), lanes, share + k);
}

void TakeEdgeRow(double distance, double low, double high, std::size_t first, std::size_t last,
                 double* share) {
    const hn::CappedTag<double, 8> lanes;
    const hn::CappedTag<double, 1> item;
    std::size_t k = first;
    for (; k + hn::Lanes(lanes) <= last; k += hn::Lanes(lanes))
        TakeEdge(lanes, distance, low, high, k, share);
    for (; k < last; ++k)
        TakeEdge(item, distance, low, high, k, share);
}

} // namespace rodwake::measure::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::measure {

HWY_EXPORT(TakeEdgeRow);

void take_edge_row(double distance, double low, double high, std::size_t first, std::size_t last,
                   double* share) {
    HWY_DYNAMIC_DISPATCH(TakeEdgeRow)(distance, low, high, first, last, share);
}

} // namespace rodwake::measure
#endif
