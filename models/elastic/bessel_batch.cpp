// Scaled K0 and K1 of many arguments by the kernels' table. Compiled once for each instruction set
// (foreach_target includes this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bessel_batch.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "bessel_inl.hpp"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

using Lanes = hn::CappedTag<double, 8>;

/// K1 from what does not cancel: z K1 where 1/z is most of it, K0 and K1 - K0 beyond.
HWY_INLINE hn::Vec<Lanes> K1Of(const ScaledBessel<Lanes>& k, hn::Vec<Lanes> z) {
    const Lanes d;
    const auto low = hn::Lt(z, hn::Set(d, 1.0));
    const auto quotient = hn::Div(hn::IfThenElse(low, k.zk1, k.zd), z);
    return hn::IfThenElse(low, quotient, hn::Add(k.k0, quotient));
}

void ScaledBesselOf(const double* z, std::size_t count, double* k0, double* k1) {
    const Lanes d;
    constexpr std::size_t lanes = hn::MaxLanes(Lanes());
    HWY_ALIGN double at[lanes], both[2][lanes];
    for (std::size_t begin = 0; begin < count; begin += lanes) {
        const std::size_t used = std::min(lanes, count - begin);
        std::fill_n(at, lanes, z[begin]);
        std::copy_n(z + begin, used, at);
        const auto v = hn::Load(d, at);
        ScaledBessel<Lanes> k[1];
        BesselAt<full_shape>(d, bessel_table().rows(), {v}, {hn::Div(hn::Set(d, 1.0), v)}, k);
        hn::Store(k[0].k0, d, both[0]);
        hn::Store(K1Of(k[0], v), d, both[1]);
        std::copy_n(both[0], used, k0 + begin);
        std::copy_n(both[1], used, k1 + begin);
    }
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::elastic {

HWY_EXPORT(ScaledBesselOf);

void table_bessel(std::span<const double> z, std::span<double> k0, std::span<double> k1) {
    HWY_DYNAMIC_DISPATCH(ScaledBesselOf)(z.data(), z.size(), k0.data(), k1.data());
}

} // namespace rodwake::elastic
#endif
