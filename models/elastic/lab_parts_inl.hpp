// What a source gives at a vector of targets, in lab components, at each accuracy (include after
// foreach_target.h).

#if defined(RODWAKE_ELASTIC_LAB_PARTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_ELASTIC_LAB_PARTS_INL
#undef RODWAKE_ELASTIC_LAB_PARTS_INL
#else
#define RODWAKE_ELASTIC_LAB_PARTS_INL
#endif

#include "kernel_inl.hpp"
#include "wake_kernel.hpp"

#include <numbers>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

/// An accuracy as the kernels see it: working precision and table.
template<class T, TableShape table_shape, std::size_t most_lanes = 64 / sizeof(T)>
struct LaneKind {
    using Real = T;
    using OneLane = LaneKind<T, table_shape, 1>;
    using Lanes = hn::CappedTag<T, most_lanes>;
    using V = hn::Vec<Lanes>;
    static constexpr TableShape shape = table_shape;
    static constexpr std::size_t lane_count = hn::MaxLanes(Lanes());
    static constexpr bool single = std::is_same_v<T, float>;
};
using FullKind = LaneKind<double, full_shape>;
using FineKind = LaneKind<double, fine_shape>;
using SingleKind = LaneKind<float, single_shape>;

template<class K>
const typename K::Real* TableOf() {
    if constexpr (K::single)
        return single_bessel_table().rows();
    else if constexpr (K::shape.terms == fine_shape.terms)
        return fine_bessel_table().rows();
    else
        return bessel_table().rows();
}

/// Coordinates of the lanes, double at any accuracy: it is their differences that may be rounded.
template<class K>
struct Coordinates {
    static constexpr std::size_t vectors = K::single && K::lane_count > 1 ? 2 : 1;
    using Wide = hn::CappedTag<double, K::lane_count / vectors>;
    hn::Vec<Wide> part[vectors];
};

template<class K>
HWY_INLINE Coordinates<K> LoadCoordinates(const double* from) {
    Coordinates<K> all;
    for (std::size_t k = 0; k < all.vectors; ++k)
        all.part[k] = hn::LoadU(typename Coordinates<K>::Wide(), from + k * (K::lane_count / all.vectors));
    return all;
}

template<class K>
HWY_INLINE Coordinates<K> SetCoordinates(double value) {
    Coordinates<K> all;
    for (std::size_t k = 0; k < all.vectors; ++k)
        all.part[k] = hn::Set(typename Coordinates<K>::Wide(), value);
    return all;
}

/// (a - b) scale in the working precision.
template<class K>
HWY_INLINE typename K::V Offset(const Coordinates<K>& a, const Coordinates<K>& b, double scale) {
    const typename Coordinates<K>::Wide wide;
    const auto difference = [&](std::size_t k) HWY_ATTR {
        return hn::Mul(hn::Sub(a.part[k], b.part[k]), hn::Set(wide, scale));
    };
    [[maybe_unused]] const typename K::Lanes d;
    if constexpr (!K::single) {
        return difference(0);
    } else if constexpr (K::lane_count == 1) {
        return hn::DemoteTo(d, difference(0));
    } else {
#if HWY_TARGET != HWY_SCALAR
        const hn::Half<typename K::Lanes> half;
        return hn::Combine(d, hn::DemoteTo(half, difference(1)), hn::DemoteTo(half, difference(0)));
#endif
    }
}

/// What a source gives at each lane, lab components.
template<class K>
struct PartVectors {
    typename K::V part[all_parts];
};

template<class K>
struct PartUnits {
    typename K::V strain, polar;
};

template<bool polar, class K>
HWY_INLINE PartVectors<K> LabParts(const WakeLanes<typename K::Lanes>& wake, typename K::V cosine,
                                   typename K::V sine, const PartUnits<K>& unit) {
    const typename K::Lanes d;
    using V = typename K::V;
    const V cos2 = Fms(d, cosine, cosine, hn::Mul(sine, sine)), sin2 = hn::Mul(hn::Add(sine, sine), cosine);
    // halves of trace, eps_yy - eps_xx and 2 eps_xy
    const V half = hn::Mul(unit.strain, hn::Set(d, typename K::Real{0.5})), mean = hn::Mul(half, wake.trace);
    const V own_across = hn::Mul(half, hn::Sub(wake.yy, wake.trace)), own_shear = hn::Mul(half, wake.shear);
    const V across = Fma(d, own_across, cos2, hn::Mul(own_shear, sin2));
    PartVectors<K> parts;
    parts.part[0] = hn::Sub(mean, across);
    parts.part[1] = Fms(d, own_shear, cos2, hn::Mul(own_across, sin2));
    parts.part[2] = hn::Add(mean, across);
    if constexpr (polar) {
        const V c = hn::Mul(unit.polar, cosine), s = hn::Mul(unit.polar, sine);
        parts.part[3] = Fms(d, wake.laplacian_x, c, hn::Mul(wake.laplacian_y, s));
        parts.part[4] = Fma(d, wake.laplacian_x, s, hn::Mul(wake.laplacian_y, c));
        parts.part[5] = Fms(d, wake.gradient_x, c, hn::Mul(wake.gradient_y, s));
        parts.part[6] = Fma(d, wake.gradient_x, s, hn::Mul(wake.gradient_y, c));
    }
    return parts;
}

/// What all targets share.
template<class K>
struct Setting {
    const typename K::Real* table;
    double c_shear;
    LaneMedium<typename K::Lanes> medium;
    PartUnits<K> unit;
    const Field* field;
};

template<class K>
HWY_INLINE Setting<K> SettingOf(const KernelMedium& medium, const Field& field) {
    const typename K::Lanes d;
    const auto set = [&](double value) HWY_ATTR { return hn::Set(d, static_cast<typename K::Real>(value)); };
    const double second = medium.c_shear * (0.5 * std::numbers::inv_pi);
    return {TableOf<K>(),
            medium.c_shear,
            {set(medium.c_shear), set(medium.nu), set(medium.delta), set(medium.inverse_nu)},
            {set(second), set(second * medium.c_shear)},
            &field};
}

/// Puts exact numbers in the lanes that the kernel cannot do: exact(lane, parts) gives those of a lane.
template<bool polar, class K, class Exact>
HWY_INLINE void ReplaceLanes(PartVectors<K>& parts, hn::Mask<typename K::Lanes> in_range,
                             const Exact& exact) {
    const typename K::Lanes d;
    using Real = typename K::Real;
    constexpr int count = polar ? all_parts : strain_parts;
    HWY_ALIGN Real stored[all_parts][K::lane_count], ok[K::lane_count];
    hn::Store(hn::IfThenElseZero(in_range, hn::Set(d, Real{1})), d, ok);
    for (int k = 0; k < count; ++k)
        hn::Store(parts.part[k], d, stored[k]);
    for (std::size_t lane = 0; lane < K::lane_count; ++lane) {
        double right[all_parts] = {};
        if (ok[lane] != Real{0})
            continue;
        exact(lane, right);
        for (int k = 0; k < count; ++k)
            stored[k][lane] = static_cast<Real>(right[k]);
    }
    for (int k = 0; k < count; ++k)
        parts.part[k] = hn::Load(d, stored[k]);
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
