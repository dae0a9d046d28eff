// Sums over sources, a target a lane. Compiled once for each instruction set (foreach_target includes this
// file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wake_batch.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "elastic/kernel_inl.hpp"
#include "elastic/wake_kernel.hpp"

#include <algorithm>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

using Lanes = hn::CappedTag<double, 8>;
using V = hn::Vec<Lanes>;
constexpr std::size_t lane_count = hn::MaxLanes(Lanes());

/// What a source gives at each lane, lab components.
struct Parts {
    V part[all_parts];
};

struct Units {
    V strain, polar;
};

template<bool polar>
HWY_INLINE Parts LabParts(const Wake<Lanes>& wake, V cosine, V sine, const Units& unit) {
    const Lanes d;
    const V cos2 = Fma(d, cosine, cosine, hn::Neg(hn::Mul(sine, sine))),
            sin2 = hn::Mul(hn::Add(sine, sine), cosine);
    // halves of trace, eps_yy - eps_xx and 2 eps_xy
    const V half = hn::Mul(unit.strain, hn::Set(d, 0.5)), mean = hn::Mul(half, wake.trace);
    const V own_across = hn::Mul(half, hn::Sub(wake.yy, wake.trace)), own_shear = hn::Mul(half, wake.shear);
    const V across = Fma(d, own_across, cos2, hn::Mul(own_shear, sin2));
    Parts parts;
    parts.part[0] = hn::Sub(mean, across);
    parts.part[1] = Fma(d, own_shear, cos2, hn::Neg(hn::Mul(own_across, sin2)));
    parts.part[2] = hn::Add(mean, across);
    if constexpr (polar) {
        const V c = hn::Mul(unit.polar, cosine), s = hn::Mul(unit.polar, sine);
        parts.part[3] = Fma(d, wake.laplacian_x, c, hn::Neg(hn::Mul(wake.laplacian_y, s)));
        parts.part[4] = Fma(d, wake.laplacian_x, s, hn::Mul(wake.laplacian_y, c));
        parts.part[5] = Fma(d, wake.gradient_x, c, hn::Neg(hn::Mul(wake.gradient_y, s)));
        parts.part[6] = Fma(d, wake.gradient_x, s, hn::Mul(wake.gradient_y, c));
    }
    return parts;
}

/// Puts the exact field in the lanes that the kernel cannot do.
template<bool polar>
HWY_NOINLINE void Replace(Parts& parts, hn::Mask<Lanes> in_range, const Field& field,
                          const KernelSource& source, const double* x, const double* y, std::size_t used) {
    const Lanes d;
    constexpr int count = polar ? all_parts : strain_parts;
    HWY_ALIGN double stored[all_parts][lane_count], ok[lane_count];
    hn::Store(hn::IfThenElseZero(in_range, hn::Set(d, 1.0)), d, ok);
    for (int k = 0; k < count; ++k)
        hn::Store(parts.part[k], d, stored[k]);
    for (std::size_t lane = 0; lane < used; ++lane) {
        double exact[all_parts];
        if (ok[lane] != 0.0)
            continue;
        exact_parts(field, source, x[lane], y[lane], polar, exact);
        for (int k = 0; k < count; ++k)
            stored[k][lane] = exact[k];
    }
    for (int k = 0; k < count; ++k)
        parts.part[k] = hn::Load(d, stored[k]);
}

/// What all targets share.
struct Setting {
    const double* table;
    LaneMedium<Lanes> medium;
    Units unit;
    const Field* field;
    std::span<const KernelSource> sources;
};

/// A vector of targets, of which the first `used` count.
struct Targets {
    const double *x, *y;
    std::size_t used;
};

/// Sums over the sources at some vectors of targets. Two at a time hide each other's latency, which for one
/// is longer than its work.
template<bool polar, std::size_t vectors>
HWY_INLINE void SumBlock(const Setting& with, const V (&x)[vectors], const V (&y)[vectors],
                         const Targets (&targets)[vectors], Parts (&sum)[vectors]) {
    const Lanes d;
    constexpr int count = polar ? all_parts : strain_parts;
    const LaneMedium<Lanes>& m = with.medium;
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < vectors; ++i)
        for (int k = 0; k < count; ++k)
            sum[i].part[k] = hn::Zero(d);
    for (const KernelSource& source : with.sources) {
        const V cosine = hn::Set(d, source.cosine), sine = hn::Set(d, source.sine);
        V X[vectors], Y[vectors], distance[vectors];
        RODWAKE_UNROLL
        for (std::size_t i = 0; i < vectors; ++i) {
            const V dx = hn::Mul(hn::Sub(x[i], hn::Set(d, source.x)), m.c_shear),
                    dy = hn::Mul(hn::Sub(y[i], hn::Set(d, source.y)), m.c_shear);
            X[i] = Fma(d, cosine, dx, hn::Mul(sine, dy));
            Y[i] = Fma(d, cosine, dy, hn::Neg(hn::Mul(sine, dx)));
            distance[i] = hn::Sqrt(Fma(d, X[i], X[i], hn::Mul(Y[i], Y[i])));
        }
        Radial<Lanes> radial[vectors];
        RadialAt(d, with.table, distance, m, radial);
        const Radial<Lanes>* at[vectors];
        RODWAKE_UNROLL
        for (std::size_t i = 0; i < vectors; ++i)
            at[i] = &radial[i];
        Wake<Lanes> wake[vectors];
        WakeAt<polar>(d, X, Y, at, m, wake);
        RODWAKE_UNROLL
        for (std::size_t i = 0; i < vectors; ++i) {
            Parts parts = LabParts<polar>(wake[i], cosine, sine, with.unit);
            if (HWY_UNLIKELY(!hn::AllTrue(d, radial[i].in_range)))
                Replace<polar>(parts, radial[i].in_range, *with.field, source, targets[i].x, targets[i].y,
                               targets[i].used);
            for (int k = 0; k < count; ++k)
                sum[i].part[k] = hn::Add(sum[i].part[k], parts.part[k]);
        }
    }
}

HWY_INLINE Setting SettingOf(const KernelMedium& medium, const Field& field,
                             std::span<const KernelSource> sources) {
    const Lanes d;
    const V c_shear = hn::Set(d, medium.c_shear),
            second = hn::Mul(c_shear, hn::Set(d, 0.5 * std::numbers::inv_pi));
    return {bessel_table().rows(),
            {c_shear, hn::Set(d, medium.nu), hn::Set(d, medium.delta), hn::Set(d, medium.inverse_nu)},
            {second, hn::Mul(second, c_shear)},
            &field,
            sources};
}

/// The last targets, less than a vector or two of them: filled up with the last one.
template<bool polar>
HWY_NOINLINE void SumRest(const Setting& with, const KernelTargets& targets, std::size_t begin) {
    const Lanes d;
    double x[lane_count], y[lane_count], last[lane_count];
    const std::size_t used = std::min(targets.count - begin, lane_count);
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
        x[lane] = targets.x[begin + std::min(lane, used - 1)];
        y[lane] = targets.y[begin + std::min(lane, used - 1)];
    }
    Parts sum[1];
    SumBlock<polar, 1>(with, {hn::LoadU(d, x)}, {hn::LoadU(d, y)}, {{x, y, used}}, sum);
    for (int k = 0; k < (polar ? all_parts : strain_parts); ++k) {
        hn::StoreU(sum[0].part[k], d, last);
        std::copy(last, last + used, targets.sum[k] + begin);
    }
}

template<bool polar>
HWY_INLINE void SumWakes(const KernelMedium& medium, const Field& field,
                         std::span<const KernelSource> sources, const KernelTargets& targets) {
    const Lanes d;
    const Setting with = SettingOf(medium, field, sources);
    std::size_t begin = 0;
    for (; begin + 2 * lane_count <= targets.count; begin += 2 * lane_count) {
        const double *x0 = targets.x + begin, *y0 = targets.y + begin, *x1 = x0 + lane_count,
                     *y1 = y0 + lane_count;
        const V x[2] = {hn::LoadU(d, x0), hn::LoadU(d, x1)}, y[2] = {hn::LoadU(d, y0), hn::LoadU(d, y1)};
        Parts sum[2];
        SumBlock<polar, 2>(with, x, y, {{x0, y0, lane_count}, {x1, y1, lane_count}}, sum);
        for (int k = 0; k < (polar ? all_parts : strain_parts); ++k) {
            hn::StoreU(sum[0].part[k], d, targets.sum[k] + begin);
            hn::StoreU(sum[1].part[k], d, targets.sum[k] + begin + lane_count);
        }
    }
    for (; begin < targets.count; begin += lane_count)
        SumRest<polar>(with, targets, begin);
}

SymmetricTensor StrainAt(const KernelMedium& medium, const Field& field, const KernelSource& source, double x,
                         double y) {
    const Lanes d;
    Parts sum[1];
    SumBlock<false, 1>(SettingOf(medium, field, {&source, 1}), {hn::Set(d, x)}, {hn::Set(d, y)},
                       {{&x, &y, 1}}, sum);
    return {hn::GetLane(sum[0].part[0]), hn::GetLane(sum[0].part[1]), hn::GetLane(sum[0].part[2])};
}

void SumStrain(const KernelMedium& medium, const Field& field, std::span<const KernelSource> sources,
               const KernelTargets& targets) {
    SumWakes<false>(medium, field, sources, targets);
}

void SumStrainAndPolar(const KernelMedium& medium, const Field& field, std::span<const KernelSource> sources,
                       const KernelTargets& targets) {
    SumWakes<true>(medium, field, sources, targets);
}

const char* Target() { return hwy::TargetName(HWY_TARGET); }

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::elastic {

HWY_EXPORT(StrainAt);
HWY_EXPORT(SumStrain);
HWY_EXPORT(SumStrainAndPolar);
HWY_EXPORT(Target);

void sum_wakes(const KernelMedium& medium, const Field& field, std::span<const KernelSource> sources,
               const KernelTargets& targets) {
    if (targets.sum[strain_parts] != nullptr)
        HWY_DYNAMIC_DISPATCH(SumStrainAndPolar)(medium, field, sources, targets);
    else
        HWY_DYNAMIC_DISPATCH(SumStrain)(medium, field, sources, targets);
}

SymmetricTensor strain_at(const KernelMedium& medium, const Field& field, const KernelSource& source,
                          double x, double y) {
    return HWY_DYNAMIC_DISPATCH(StrainAt)(medium, field, source, x, y);
}

std::string wake_kernel_target() { return HWY_DYNAMIC_DISPATCH(Target)(); }

} // namespace rodwake::elastic
#endif
