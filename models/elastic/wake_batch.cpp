// Sums over sources, a target a lane. Compiled once for each instruction set (foreach_target includes this
// file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wake_batch.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "lab_parts_inl.hpp"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

/// A vector of targets, of which the first `used` count.
struct Targets {
    const double *x, *y;
    std::size_t used;
};

/// Puts the exact field in the lanes that the kernel cannot do.
template<bool polar, class K>
HWY_NOINLINE void Replace(PartVectors<K>& parts, hn::Mask<typename K::Lanes> in_range, const Field& field,
                          const KernelSource& source, const Targets& targets) {
    ReplaceLanes<polar, K>(parts, in_range, [&](std::size_t lane, double* exact) {
        if (lane < targets.used)
            exact_parts(field, source, targets.x[lane], targets.y[lane], polar, exact);
    });
}

/// Adds what the sources give at some vectors of targets. Two at a time hide each other's latency, which for
/// one is longer than its work.
template<bool polar, class K, std::size_t vectors>
HWY_INLINE void SumBlock(const Setting<K>& with, std::span<const KernelSource> sources,
                         const Targets (&targets)[vectors], PartVectors<K> (&sum)[vectors]) {
    const typename K::Lanes d;
    using V = typename K::V;
    using Real = typename K::Real;
    constexpr int count = polar ? all_parts : strain_parts;
    Coordinates<K> x[vectors], y[vectors];
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < vectors; ++i) {
        x[i] = LoadCoordinates<K>(targets[i].x);
        y[i] = LoadCoordinates<K>(targets[i].y);
        for (int k = 0; k < count; ++k)
            sum[i].part[k] = hn::Zero(d);
    }
    for (const KernelSource& source : sources) {
        const V cosine = hn::Set(d, static_cast<Real>(source.cosine)),
                sine = hn::Set(d, static_cast<Real>(source.sine));
        V X[vectors], Y[vectors], distance[vectors];
        RODWAKE_UNROLL
        for (std::size_t i = 0; i < vectors; ++i) {
            const V dx = Offset(x[i], SetCoordinates<K>(source.x), with.c_shear),
                    dy = Offset(y[i], SetCoordinates<K>(source.y), with.c_shear);
            X[i] = Fma(d, cosine, dx, hn::Mul(sine, dy));
            Y[i] = Fms(d, cosine, dy, hn::Mul(sine, dx));
            distance[i] = hn::Sqrt(Fma(d, X[i], X[i], hn::Mul(Y[i], Y[i])));
        }
        Radial<typename K::Lanes> radial[vectors];
        RadialAt<K::shape>(d, with.table, distance, with.medium, radial);
        const Radial<typename K::Lanes>* at[vectors];
        RODWAKE_UNROLL
        for (std::size_t i = 0; i < vectors; ++i)
            at[i] = &radial[i];
        WakeLanes<typename K::Lanes> wake[vectors];
        WakeAt<polar, K::shape>(d, X, Y, at, with.medium, wake);
        RODWAKE_UNROLL
        for (std::size_t i = 0; i < vectors; ++i) {
            PartVectors<K> parts = LabParts<polar>(wake[i], cosine, sine, with.unit);
            if (HWY_UNLIKELY(!hn::AllTrue(d, radial[i].in_range)))
                Replace<polar, K>(parts, radial[i].in_range, *with.field, source, targets[i]);
            for (int k = 0; k < count; ++k)
                sum[i].part[k] = hn::Add(sum[i].part[k], parts.part[k]);
        }
    }
}

/// Sources added up in single precision before they go to a sum in double.
constexpr std::size_t single_run = 64;

/// Puts the numbers of the lanes in, or adds them to, `used` doubles.
template<class K>
HWY_INLINE void Deliver(typename K::V v, double* to, std::size_t used, bool add) {
    const typename K::Lanes d;
    if (!K::single && !add && used == K::lane_count) {
        if constexpr (!K::single)
            hn::StoreU(v, d, to);
        return;
    }
    HWY_ALIGN typename K::Real stored[K::lane_count];
    hn::Store(v, d, stored);
    for (std::size_t lane = 0; lane < used; ++lane)
        to[lane] = (add ? to[lane] : 0.0) + static_cast<double>(stored[lane]);
}

/// The sums of some vectors of targets, from number `begin` on.
template<bool polar, class K, std::size_t vectors>
HWY_INLINE void SumTargets(const Setting<K>& with, std::span<const KernelSource> sources,
                           const Targets (&targets)[vectors], double* const (&sum)[all_parts],
                           std::size_t begin) {
    std::size_t from = 0;
    do {
        const std::size_t left = sources.size() - from, run = K::single ? std::min(single_run, left) : left;
        PartVectors<K> parts[vectors];
        SumBlock<polar, K>(with, sources.subspan(from, run), targets, parts);
        for (int k = 0; k < (polar ? all_parts : strain_parts); ++k)
            for (std::size_t i = 0; i < vectors; ++i)
                Deliver<K>(parts[i].part[k], sum[k] + begin + i * K::lane_count, targets[i].used, from > 0);
        from += run;
    } while (from < sources.size());
}

/// A single target does not wait for a vector.
template<bool polar, class K>
HWY_NOINLINE void SumOne(const KernelMedium& medium, const Field& field,
                         std::span<const KernelSource> sources, const KernelTargets& targets,
                         std::size_t at) {
    SumTargets<polar, K, 1>(SettingOf<K>(medium, field), sources, {{targets.x + at, targets.y + at, 1}},
                            targets.sum, at);
}

/// The last targets, less than a vector or two of them: filled up with the last one.
template<bool polar, class K>
HWY_NOINLINE void SumRest(const Setting<K>& with, std::span<const KernelSource> sources,
                          const KernelTargets& targets, std::size_t begin) {
    double x[K::lane_count], y[K::lane_count];
    const std::size_t used = std::min(targets.count - begin, K::lane_count);
    for (std::size_t lane = 0; lane < K::lane_count; ++lane) {
        x[lane] = targets.x[begin + std::min(lane, used - 1)];
        y[lane] = targets.y[begin + std::min(lane, used - 1)];
    }
    SumTargets<polar, K, 1>(with, sources, {{x, y, used}}, targets.sum, begin);
}

template<bool polar, class K>
HWY_NOINLINE void SumWakes(const KernelMedium& medium, const Field& field,
                           std::span<const KernelSource> sources, const KernelTargets& targets) {
    constexpr std::size_t n = K::lane_count;
    if (targets.count == 1)
        return SumOne<polar, typename K::OneLane>(medium, field, sources, targets, 0);
    const Setting<K> with = SettingOf<K>(medium, field);
    std::size_t begin = 0;
    for (; begin + 2 * n <= targets.count; begin += 2 * n) {
        const double *x = targets.x + begin, *y = targets.y + begin;
        SumTargets<polar, K, 2>(with, sources, {{x, y, n}, {x + n, y + n, n}}, targets.sum, begin);
    }
    for (; begin < targets.count; begin += n)
        SumRest<polar, K>(with, sources, targets, begin);
}

template<class K>
void SumEither(const KernelMedium& medium, const Field& field, std::span<const KernelSource> sources,
               const KernelTargets& targets) {
    if (targets.sum[strain_parts] != nullptr)
        SumWakes<true, K>(medium, field, sources, targets);
    else
        SumWakes<false, K>(medium, field, sources, targets);
}

void SumAt(const KernelMedium& medium, const Field& field, Accuracy accuracy,
           std::span<const KernelSource> sources, const KernelTargets& targets) {
    switch (accuracy) {
    case Accuracy::full:
        return SumEither<FullKind>(medium, field, sources, targets);
    case Accuracy::fine:
        return SumEither<FineKind>(medium, field, sources, targets);
    case Accuracy::single:
        return SumEither<SingleKind>(medium, field, sources, targets);
    }
}

const char* Target() { return hwy::TargetName(HWY_TARGET); }

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::elastic {

HWY_EXPORT(SumAt);
HWY_EXPORT(Target);

void sum_wakes(const KernelMedium& medium, const Field& field, Accuracy accuracy,
               std::span<const KernelSource> sources, const KernelTargets& targets) {
    HWY_DYNAMIC_DISPATCH(SumAt)(medium, field, accuracy, sources, targets);
}

std::string wake_kernel_target() { return HWY_DYNAMIC_DISPATCH(Target)(); }

} // namespace rodwake::elastic
#endif
