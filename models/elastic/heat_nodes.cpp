// Gaussians of wakes at a vector of targets. Compiled once for each instruction set (foreach_target includes
// this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "heat_nodes.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "heat_nodes.hpp"
#include "lab_parts_inl.hpp"

#include <cmath>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

using Lanes = FullKind::Lanes;
using V = FullKind::V;
static_assert(heat_lanes == 8); // as FullKind has at most

/// Sums in the source's frame: trace, eps_xx - eps_yy, 2 eps_xy; then lap U and grad div U.
struct HeatSums {
    V part[all_parts];
};

/// Second and third derivative of Phi.
struct Potential {
    V second, third;
};

HWY_INLINE Potential Series(const HeatNode& node, V rho) {
    const Lanes d;
    Potential p{hn::Zero(d), hn::Zero(d)};
    for (std::size_t n = node.series.size(); n >= 2; --n) {
        const double c = node.series[n - 1] * static_cast<double>(n - 1);
        p.second = Fma(d, p.second, rho, hn::Set(d, c));
        if (n >= 3)
            p.third = Fma(d, p.third, rho, hn::Set(d, c * static_cast<double>(n - 2)));
    }
    return p;
}

HWY_INLINE Potential PotentialAt(const HeatNode& node, V rho, V heat_t, V heat_l) {
    const Lanes d;
    const V a = hn::Set(d, node.a), b = hn::Set(d, node.b), one_over = hn::Div(hn::Set(d, 1.0), rho);
    const V first = hn::Mul(
        hn::Sub(hn::Mul(heat_t, hn::Set(d, 0.25 / node.a)), hn::Mul(heat_l, hn::Set(d, 0.25 / node.b))),
        one_over);
    const V second = hn::Mul(Fms(d, hn::Sub(heat_l, heat_t), hn::Set(d, 0.25), first), one_over);
    const V third = hn::Mul(
        Fms(d, hn::Sub(hn::Mul(a, heat_t), hn::Mul(b, heat_l)), hn::Set(d, 0.25), hn::Add(second, second)),
        one_over);
    const auto near = hn::Lt(hn::Mul(rho, a), hn::Set(d, 0.1));
    if (HWY_LIKELY(hn::AllFalse(d, near)))
        return {second, third};
    const Potential series = Series(node, rho);
    return {hn::IfThenElse(near, series.second, second), hn::IfThenElse(near, series.third, third)};
}

template<bool polar>
HWY_INLINE void AddNode(const HeatNode& node, V w, V x, V y, HeatSums& sums) {
    const Lanes d;
    const V a = hn::Set(d, node.a), b = hn::Set(d, node.b);
    const V xx = hn::Mul(x, x), yy = hn::Mul(y, y), rho = hn::Add(xx, yy);
    const V exponents[2] = {hn::Mul(a, rho), hn::Mul(b, rho)};
    Exponential<Lanes> e[2];
    ExpMinus(d, exponents, e);
    const V heat_t = hn::Mul(e[0].value, hn::Set(d, node.a * std::numbers::inv_pi)),
            heat_l = hn::Mul(e[1].value, hn::Set(d, node.b * std::numbers::inv_pi));
    const Potential phi = PotentialAt(node, rho, heat_t, heat_l);
    const V bl = hn::Mul(b, heat_l), at = hn::Mul(a, heat_t);
    const V two = hn::Set(d, -2.0), eight = hn::Set(d, 8.0);
    const V trace = hn::Mul(two, hn::Mul(x, bl));
    // of x and y: -2 a g_T + 8 (Phi'' + (x^2 - y^2) Phi'''),  -2 a g_T + 8 Phi'' + 16 x^2 Phi'''
    const V common = Fma(d, eight, phi.second, hn::Mul(two, at)), third = hn::Mul(eight, phi.third);
    const V difference = hn::Mul(x, Fma(d, hn::Sub(xx, yy), third, common));
    const V shear = hn::Mul(y, Fma(d, hn::Add(xx, xx), third, common));
    sums.part[0] = Fma(d, w, trace, sums.part[0]);
    sums.part[1] = Fma(d, w, difference, sums.part[1]);
    sums.part[2] = Fma(d, w, shear, sums.part[2]);
    if constexpr (polar) {
        const V four = hn::Set(d, 4.0), aat = hn::Mul(four, hn::Mul(a, at)),
                bbl = hn::Mul(four, hn::Mul(b, bl)), xy = hn::Mul(x, y);
        const V gradient_x = Fma(d, two, bl, hn::Mul(bbl, xx)), gradient_y = hn::Mul(bbl, xy);
        const V parts[4] = {hn::Add(Fma(d, two, at, hn::Mul(aat, yy)), gradient_x),
                            hn::Sub(gradient_y, hn::Mul(aat, xy)), gradient_x, gradient_y};
        for (int k = 0; k < 4; ++k)
            sums.part[strain_parts + k] = Fma(d, w, parts[k], sums.part[strain_parts + k]);
    }
}

template<bool polar>
constexpr int PartsOf() {
    return polar ? all_parts : strain_parts;
}

template<bool polar>
HWY_INLINE HeatSums NoHeat() {
    HeatSums none;
    for (int k = 0; k < PartsOf<polar>(); ++k)
        none.part[k] = hn::Zero(Lanes());
    return none;
}

/// Turns sources' sums into the lab.
template<bool polar>
HWY_INLINE void Turn(V cosine, V sine, const HeatSums& own, HeatSums& lab) {
    const Lanes d;
    const V c2 = Fms(d, cosine, cosine, hn::Mul(sine, sine)), half = hn::Set(d, 0.5);
    const V sc = hn::Mul(sine, cosine), s2 = hn::Add(sc, sc);
    const V difference = Fms(d, own.part[1], c2, hn::Mul(own.part[2], s2)),
            shear = Fma(d, own.part[1], s2, hn::Mul(own.part[2], c2));
    lab.part[0] = Fma(d, half, hn::Add(own.part[0], difference), lab.part[0]);
    lab.part[1] = Fma(d, half, shear, lab.part[1]);
    lab.part[2] = Fma(d, half, hn::Sub(own.part[0], difference), lab.part[2]);
    if constexpr (polar)
        for (int k = strain_parts; k < all_parts; k += 2) {
            const V x = own.part[k], y = own.part[k + 1];
            lab.part[k] = hn::Add(lab.part[k], Fms(d, x, cosine, hn::Mul(y, sine)));
            lab.part[k + 1] = hn::Add(lab.part[k + 1], Fma(d, x, sine, hn::Mul(y, cosine)));
        }
}

/// As seen by a source.
struct Seen {
    V x, y;
};
HWY_INLINE Seen SeenFrom(V dx, V dy, V cosine, V sine) {
    const Lanes d;
    return {Fma(d, cosine, dx, hn::Mul(sine, dy)), Fms(d, cosine, dy, hn::Mul(sine, dx))};
}

template<bool polar>
HWY_NOINLINE void Subtract(const HeatNode& node, const KernelSource& source, const KernelTargets& targets) {
    const Lanes d;
    for (std::size_t i = 0; i < heat_lanes; i += hn::Lanes(d)) {
        const V dx = hn::Sub(hn::LoadU(d, targets.x + i), hn::Set(d, source.x)),
                dy = hn::Sub(hn::LoadU(d, targets.y + i), hn::Set(d, source.y));
        const V cosine = hn::Set(d, source.cosine), sine = hn::Set(d, source.sine);
        const Seen at = SeenFrom(dx, dy, cosine, sine);
        HeatSums own = NoHeat<polar>(), lab = own;
        AddNode<polar>(node, hn::Set(d, node.weight), hn::Add(at.x, hn::Set(d, node.time)), at.y, own);
        Turn<polar>(cosine, sine, own, lab);
        for (int k = 0; k < PartsOf<polar>(); ++k)
            hn::StoreU(hn::Sub(hn::LoadU(d, targets.sum[k] + i), lab.part[k]), d, targets.sum[k] + i);
    }
}

void SubtractHeat(const HeatNode& node, const KernelSource& source, const KernelTargets& targets) {
    if (targets.sum[strain_parts] != nullptr)
        Subtract<true>(node, source, targets);
    else
        Subtract<false>(node, source, targets);
}

// Near pairs, a source a lane.

/// The polynomials of a part at x and y^2.
HWY_INLINE V PolynomialAt(const std::array<double, NearHeat::terms>& c, V x, V yy) {
    const Lanes d;
    V sum = hn::Zero(d);
    std::size_t end = NearHeat::terms;
    for (std::size_t length = 1; length <= NearHeat::degree + 1; length += 2) { // of the last row, and so on
        V row = hn::Set(d, c[end - 1]);
        for (std::size_t i = 1; i < length; ++i)
            row = Fma(d, row, x, hn::Set(d, c[end - 1 - i]));
        end -= length;
        sum = Fma(d, sum, yy, row);
    }
    return sum;
}

template<bool polar>
HWY_INLINE HeatSums HeatAt(const NearHeat& heat, const Seen& at) {
    const Lanes d;
    const V scale = hn::Set(d, 1.0 / heat.reach), x = hn::Mul(at.x, scale), y = hn::Mul(at.y, scale),
            yy = hn::Mul(y, y);
    HeatSums own;
    for (int k = 0; k < PartsOf<polar>(); ++k) {
        const V value = PolynomialAt(heat.part[k], x, yy);
        own.part[k] = NearHeat::odd[k] ? hn::Mul(value, y) : value;
    }
    for (const HeatNode& node : heat.nodes) {
        const V from = hn::Add(at.x, hn::Set(d, node.time)), square = Fma(d, from, from, hn::Mul(at.y, at.y));
        const auto felt = hn::Lt(square, hn::Set(d, heat.cutoff / node.b));
        if (!hn::AllFalse(d, felt)) // a lane does not know of the others
            AddNode<polar>(node, hn::IfThenElseZero(felt, hn::Set(d, node.weight)), from, at.y, own);
    }
    return own;
}

/// The exact field of a vector of sources, which need not be near enough for its table.
template<bool polar>
HWY_INLINE Parts<FullKind> ExactAt(const Setting<FullKind>& with, const NearSources& sources,
                                   std::size_t first, double x, double y, const Seen& at, V cosine, V sine) {
    const Lanes d;
    const V scale = hn::Set(d, with.c_shear);
    const V X[1] = {hn::Mul(at.x, scale)}, Y[1] = {hn::Mul(at.y, scale)};
    const V distance[1] = {hn::Sqrt(Fma(d, X[0], X[0], hn::Mul(Y[0], Y[0])))};
    Radial<Lanes> radial[1];
    RadialAt<FullKind::shape>(d, with.table, distance, with.medium, radial);
    const Radial<Lanes>* shown[1] = {&radial[0]};
    Wake<Lanes> wake[1];
    WakeAt<polar, FullKind::shape>(d, X, Y, shown, with.medium, wake);
    Parts<FullKind> parts = LabParts<polar>(wake[0], cosine, sine, with.unit);
    if (HWY_UNLIKELY(!hn::AllTrue(d, radial[0].in_range)))
        ReplaceLanes<polar, FullKind>(parts, radial[0].in_range, [&](std::size_t lane, double* exact) {
            const std::size_t k = first + lane;
            exact_parts(*with.field, {sources.x[k], sources.y[k], sources.cosine[k], sources.sine[k]}, x, y,
                        polar, exact);
        });
    return parts;
}

/// What sources give at (x, y), less what the heat gives.
template<bool polar>
HWY_INLINE Parts<FullKind> NearAt(const Setting<FullKind>& with, const NearHeat& heat,
                                  const NearSources& sources, std::size_t first, double x, double y) {
    const Lanes d;
    const auto load = [&](const std::vector<double>& from) HWY_ATTR { return hn::LoadU(d, &from[first]); };
    const V cosine = load(sources.cosine), sine = load(sources.sine);
    const Seen at = SeenFrom(hn::Sub(hn::Set(d, x), load(sources.x)), hn::Sub(hn::Set(d, y), load(sources.y)),
                             cosine, sine);
    Parts<FullKind> parts = ExactAt<polar>(with, sources, first, x, y, at, cosine, sine);
    const double per_xi = 2.0 * with.c_shear;
    const V to_xi = hn::Set(d, per_xi), polar_unit = hn::Set(d, per_xi * per_xi);
    const HeatSums own = HeatAt<polar>(heat, {hn::Mul(at.x, to_xi), hn::Mul(at.y, to_xi)});
    HeatSums lab = NoHeat<polar>();
    Turn<polar>(cosine, sine, own, lab);
    for (int k = 0; k < PartsOf<polar>(); ++k)
        parts.part[k] = Fnma(d, lab.part[k], k < strain_parts ? to_xi : polar_unit, parts.part[k]);
    return parts;
}

template<bool polar>
HWY_NOINLINE void AddNear(const KernelMedium& medium, const Field& field, const NearHeat& heat,
                          const NearSources& sources, double x, double y, std::span<double> sums) {
    const Lanes d;
    const Setting<FullKind> with = SettingOf<FullKind>(medium, field);
    double slots[all_parts][heat_lanes] = {}; // one a lane of the longest vector, whatever vectors there are
    for (std::size_t first = 0; first < sources.x.size(); first += hn::Lanes(d)) {
        const Parts<FullKind> parts = NearAt<polar>(with, heat, sources, first, x, y);
        const V weight = hn::LoadU(d, &sources.weight[first]);
        for (int k = 0; k < PartsOf<polar>(); ++k) {
            double* slot = slots[k] + first % heat_lanes;
            hn::StoreU(Fma(d, weight, parts.part[k], hn::LoadU(d, slot)), d, slot);
        }
    }
    for (int k = 0; k < PartsOf<polar>(); ++k)
        for (const double slot : slots[k])
            sums[k] += slot;
}

void AddNearEither(const KernelMedium& medium, const Field& field, const NearHeat& heat,
                   const NearSources& sources, double x, double y, bool polar, std::span<double> sums) {
    if (polar)
        AddNear<true>(medium, field, heat, sources, x, y, sums);
    else
        AddNear<false>(medium, field, heat, sources, x, y, sums);
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::elastic {

HWY_EXPORT(SubtractHeat);
HWY_EXPORT(AddNearEither);

HeatNode heat_node(double s, double step, double eta) {
    const double t = s * s, a = 0.25 / t;
    HeatNode node{t, a, a / (1.0 + eta), 2.0 * s * step};
    double pa = 1.0, pb = 1.0, scale = 0.25 * std::numbers::inv_pi;
    for (std::size_t n = 0; n < node.series.size(); ++n) {
        pa *= node.a;
        pb *= node.b;
        scale /= -static_cast<double>(n + 1);
        node.series[n] = scale * (pa - pb);
    }
    return node;
}

void subtract_heat(const HeatNode& node, const KernelSource& source, const KernelTargets& targets) {
    HWY_DYNAMIC_DISPATCH(SubtractHeat)(node, source, targets);
}

void NearSources::clear() {
    for (auto* one : {&x, &y, &cosine, &sine, &weight})
        one->clear();
}

void NearSources::add(const KernelSource& source, double as) {
    x.push_back(source.x);
    y.push_back(source.y);
    cosine.push_back(source.cosine);
    sine.push_back(source.sine);
    weight.push_back(as);
}

void add_near(const KernelMedium& medium, const Field& field, const NearHeat& heat,
              const NearSources& sources, double x, double y, bool polar, std::span<double> sums) {
    HWY_DYNAMIC_DISPATCH(AddNearEither)(medium, field, heat, sources, x, y, polar, sums);
}

} // namespace rodwake::elastic
#endif
