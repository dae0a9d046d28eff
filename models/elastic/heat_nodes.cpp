// What nodes give, and what near pairs lack. Compiled once for each instruction set (foreach_target includes
// this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "heat_nodes.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "bessel.hpp"
#include "heat_nodes.hpp"
#include "lab_parts_inl.hpp"
#include "nonuniform_fft.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

using Lanes = FullKind::Lanes;
using V = FullKind::V;
static_assert(heat_lanes == 8); // as FullKind has at most

/// The functions of NearHeat at s, in lengths of 2 xi; returns which lanes are in the first piece.
HWY_INLINE hn::Mask<Lanes> FunctionsAt(const NearHeat& heat, V s, V (&f)[NearHeat::functions]) {
    const Lanes d;
    const hn::RebindToSigned<Lanes> i;
    constexpr auto last = static_cast<double>(NearHeat::pieces - 1);
    const V root = hn::Sqrt(hn::Mul(s, hn::Set(d, 2.0 / heat.reach)));
    const V beyond = hn::Mul(hn::Sub(root, hn::Set(d, NearHeat::first_end)),
                             hn::Set(d, last / (1.0 - NearHeat::first_end)));
    const auto nearest = hn::Lt(beyond, hn::Zero(d));
    const V at = hn::IfThenElse(nearest, hn::Mul(root, hn::Set(d, 1.0 / NearHeat::first_end)),
                                hn::Add(beyond, hn::Set(d, 1.0))),
            floor = hn::Min(hn::Floor(at), hn::Set(d, last)), rest = hn::Sub(at, floor),
            u = hn::Sub(hn::Add(rest, rest), hn::Set(d, 1.0));
    const auto piece = hn::ConvertTo(i, floor);
    const auto pick = [&](const std::array<double, NearHeat::pieces>& c) HWY_ATTR {
        if constexpr (hn::MaxLanes(d) == NearHeat::pieces)
            return hn::TableLookupLanes(hn::LoadU(d, c.data()), hn::IndicesFromVec(d, piece));
        else
            return hn::GatherIndex(d, c.data(), piece);
    };
    const NearHeat::Coefficients* row = &heat.powers.back();
    RODWAKE_UNROLL
    for (std::size_t k = 0; k < NearHeat::functions; ++k)
        f[k] = pick((*row)[k]);
    while (row-- != heat.powers.data())
        RODWAKE_UNROLL
    for (std::size_t k = 0; k < NearHeat::functions; ++k)
        f[k] = Fma(d, f[k], u, pick((*row)[k]));
    return nearest;
}

/// A potential e^(-a X) A(s) from its radial functions, without its exponential: Laplacian and its gradient.
struct Potential {
    V laplacian, along, radial; ///< gradient: along x and along r
};

HWY_INLINE Potential PotentialOf(V a, V x, V s, V c, const V* f) {
    const Lanes d;
    const V two = hn::Set(d, 2.0), around = Fma(d, two, f[1], f[2]), bent = hn::Mul(a, f[1]);
    Potential p;
    p.laplacian = Fma(d, hn::Mul(a, a), f[0], Fnma(d, hn::Add(x, x), bent, around));
    p.along = hn::Neg(Fma(d, a, p.laplacian, hn::Add(bent, bent)));
    p.radial = hn::Add(Fms(d, hn::Mul(a, s), bent, hn::Mul(hn::Mul(two, a), hn::Mul(c, f[2]))), f[3]);
    return p;
}

/// A wake from its radial functions, in the units of WakeFrom.
template<bool polar>
HWY_INLINE WakeLanes<Lanes> WakeOf(const V (&f)[NearHeat::functions], V x, V y, V s, const Bearing<Lanes>& b,
                                   V nu) {
    const Lanes d;
    const V *t = f, *l = f + NearHeat::functions / 2;
    const V one = hn::Set(d, 1.0), half = hn::Set(d, 0.5), cq = hn::Mul(b.c, b.q), qq = hn::Mul(b.q, b.q);
    const Potential shear = PotentialOf(one, x, s, b.c, t), longitudinal = PotentialOf(nu, x, s, b.c, l);
    const V first_x = Fms(d, x, t[1], t[0]), first_y = hn::Mul(y, t[1]); // of the gradient
    const auto both = [&](V of_t, V of_l) HWY_ATTR { return Fms(d, b.e_t, of_t, hn::Mul(b.e_l, of_l)); };
    WakeLanes<Lanes> wake;
    wake.trace = Fma(d, half, both(shear.laplacian, longitudinal.laplacian), hn::Mul(b.e_t, first_x));
    wake.yy = both(Fma(d, qq, t[2], t[1]), Fma(d, qq, l[2], l[1]));
    wake.shear = both(hn::Mul(cq, t[2]), Fms(d, cq, l[2], hn::Mul(nu, hn::Mul(y, l[1]))));
    if constexpr (polar) {
        const V along = hn::Mul(half, both(shear.along, longitudinal.along)),
                radial = hn::Mul(half, both(shear.radial, longitudinal.radial));
        const V gradient_x = Fma(d, radial, b.c, along), gradient_y = hn::Mul(radial, b.q);
        wake.laplacian_x = Fma(d, b.e_t, shear.laplacian, gradient_x);
        wake.laplacian_y = gradient_y;
        const V xx = hn::Add(Fnma(d, x, t[1], Fms(d, b.c, hn::Mul(b.c, t[2]), first_x)), t[1]);
        wake.gradient_x = Fma(d, b.e_t, xx, gradient_x);
        wake.gradient_y = Fma(d, b.e_t, Fms(d, cq, t[2], first_y), gradient_y);
    }
    return wake;
}

/// Adds the exact field in these lanes.
template<bool polar>
HWY_NOINLINE hn::Mask<Lanes> AddExact(const Setting<FullKind>& with, const V (&X)[1], const V (&Y)[1],
                                      V distance, hn::Mask<Lanes> lanes, WakeLanes<Lanes>& wake) {
    const Lanes d;
    const V distances[1] = {distance};
    Radial<Lanes> radial[1];
    RadialAt<FullKind::shape>(d, with.table, distances, with.medium, radial);
    const Radial<Lanes>* const shown[1] = {&radial[0]};
    WakeLanes<Lanes> exact[1];
    WakeAt<polar, FullKind::shape>(d, X, Y, shown, with.medium, exact);
    const auto add = [&](V WakeLanes<Lanes>::*part) HWY_ATTR {
        wake.*part = hn::Add(wake.*part, hn::IfThenElseZero(lanes, exact[0].*part));
    };
    for (const auto part : {&WakeLanes<Lanes>::trace, &WakeLanes<Lanes>::yy, &WakeLanes<Lanes>::shear})
        add(part);
    if constexpr (polar)
        for (const auto part : {&WakeLanes<Lanes>::laplacian_x, &WakeLanes<Lanes>::laplacian_y,
                                &WakeLanes<Lanes>::gradient_x, &WakeLanes<Lanes>::gradient_y})
            add(part);
    return hn::Or(radial[0].in_range, hn::Not(lanes));
}

/// What a vector of sources gives at (x, y), less their heat. Rods that are too near for the table lose none:
/// it is nothing beside their wake.
template<bool polar>
HWY_INLINE PartVectors<FullKind> NearAt(const Setting<FullKind>& with, const NearHeat& heat,
                                        const NearSources& sources, std::size_t first, double x, double y) {
    const Lanes d;
    const auto load = [&](const std::vector<double>& from) HWY_ATTR { return hn::LoadU(d, &from[first]); };
    const V cosine = load(sources.cosine), sine = load(sources.sine), scale = hn::Set(d, with.c_shear);
    const V dx = hn::Mul(hn::Sub(hn::Set(d, x), load(sources.x)), scale),
            dy = hn::Mul(hn::Sub(hn::Set(d, y), load(sources.y)), scale);
    const V X[1] = {Fma(d, cosine, dx, hn::Mul(sine, dy))}, Y[1] = {Fms(d, cosine, dy, hn::Mul(sine, dx))};
    Radial<Lanes> position;
    position.s = hn::Sqrt(Fma(d, dx, dx, hn::Mul(dy, dy)));
    position.inverse = hn::Div(hn::Set(d, 1.0), position.s);
    const Radial<Lanes>* const shown[1] = {&position};
    Bearing<Lanes> bearing[1];
    BearingsOf<FullKind::shape>(d, X, Y, shown, with.medium, bearing);
    V f[NearHeat::functions];
    const auto nearest = FunctionsAt(heat, position.s, f);
    WakeLanes<Lanes> wake = WakeOf<polar>(f, X[0], Y[0], position.s, bearing[0], with.medium.nu);
    if (HWY_LIKELY(hn::AllFalse(d, nearest)))
        return LabParts<polar>(wake, cosine, sine, with.unit);
    const auto in_range = AddExact<polar>(with, X, Y, position.s, nearest, wake);
    PartVectors<FullKind> parts = LabParts<polar>(wake, cosine, sine, with.unit);
    if (HWY_UNLIKELY(!hn::AllTrue(d, in_range)))
        ReplaceLanes<polar, FullKind>(parts, in_range, [&](std::size_t lane, double* exact) {
            const std::size_t k = first + lane;
            exact_parts(*with.field, {sources.x[k], sources.y[k], sources.cosine[k], sources.sine[k]}, x, y,
                        polar, exact);
        });
    return parts;
}

void PartsAt(const WakeFunctions& functions, const KernelMedium& medium, const Field& field, double s,
             const double* cosine, const double* sine, double (*parts)[heat_lanes]) {
    const Lanes d;
    const Setting<FullKind> with = SettingOf<FullKind>(medium, field);
    V f[NearHeat::functions];
    for (std::size_t k = 0; k < NearHeat::functions; ++k)
        f[k] = hn::Set(d, functions[k]);
    Radial<Lanes> position;
    position.s = hn::Set(d, s);
    position.inverse = hn::Set(d, s > 0.0 ? 1.0 / s : 0.0);
    const Radial<Lanes>* const shown[1] = {&position};
    for (std::size_t k = 0; k < heat_lanes; k += hn::Lanes(d)) {
        const V X[1] = {hn::Mul(position.s, hn::LoadU(d, cosine + k))},
                Y[1] = {hn::Mul(position.s, hn::LoadU(d, sine + k))};
        Bearing<Lanes> bearing[1];
        BearingsOf<FullKind::shape>(d, X, Y, shown, with.medium, bearing);
        const WakeLanes<Lanes> wake = WakeOf<true>(f, X[0], Y[0], position.s, bearing[0], with.medium.nu);
        const PartVectors<FullKind> lab = LabParts<true>(wake, hn::Set(d, 1.0), hn::Zero(d), with.unit);
        for (int part = 0; part < all_parts; ++part)
            hn::StoreU(lab.part[part], d, parts[part] + k);
    }
}

template<bool polar>
HWY_NOINLINE void AddNear(const KernelMedium& medium, const Field& field, const NearHeat& heat,
                          const NearSources& sources, double x, double y, std::span<double> sums) {
    const Lanes d;
    const Setting<FullKind> with = SettingOf<FullKind>(medium, field);
    double slots[all_parts][heat_lanes] = {}; // one a lane of the longest vector, whatever vectors there are
    for (std::size_t first = 0; first < sources.count; first += hn::Lanes(d)) {
        const PartVectors<FullKind> parts = NearAt<polar>(with, heat, sources, first, x, y);
        const auto meant = hn::FirstN(d, sources.count - first);
        for (int k = 0; k < (polar ? all_parts : strain_parts); ++k) {
            double* slot = slots[k] + first % heat_lanes;
            hn::StoreU(hn::Add(hn::IfThenElseZero(meant, parts.part[k]), hn::LoadU(d, slot)), d, slot);
        }
    }
    for (int k = 0; k < (polar ? all_parts : strain_parts); ++k)
        for (const double slot : slots[k])
            sums[k] += slot;
}

void AddNearEither(const KernelMedium& medium, const Field& field, const NearHeat& heat,
                   const NearSources& sources, double x, double y, bool polar, std::span<double> sums) {
    const auto add = polar ? AddNear<true> : AddNear<false>;
    add(medium, field, heat, sources, x, y, sums);
}

void FindNear(const NearSources& from, double x, double y, double distance, double number, NearSources& to) {
    const Lanes d;
    to.count = 0;
    for (std::size_t k = 0; k < from.count; k += hn::Lanes(d)) {
        const V dx = hn::Sub(hn::LoadU(d, &from.x[k]), hn::Set(d, x)),
                dy = hn::Sub(hn::LoadU(d, &from.y[k]), hn::Set(d, y));
        const auto near = hn::Le(Fma(d, dx, dx, hn::Mul(dy, dy)), hn::Set(d, distance * distance)),
                   other = hn::Ne(hn::LoadU(d, &from.number[k]), hn::Set(d, number));
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::And(hn::And(near, other), hn::FirstN(d, from.count - k)), bits);
        for (unsigned rest = bits[0]; rest != 0; rest &= rest - 1)
            to.take(from, k + static_cast<std::size_t>(std::countr_zero(rest)));
    }
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::elastic {

HWY_EXPORT(PartsAt);
HWY_EXPORT(AddNearEither);
HWY_EXPORT(FindNear);

WakeFunctions exact_functions(double eta, double s) {
    WakeFunctions f;
    double* to = f.data();
    for (const double a : {1.0, 1.0 / (1.0 + eta)}) {
        const double z = a * s;
        double k0 = 0.0, k1 = 0.0;
        table_bessel({&z, 1}, {&k0, 1}, {&k1, 1});
        const double slope = -a * k1, per_s = slope / s;
        for (const double value : {k0, per_s, a * a * k0 - 2.0 * per_s, a * a * slope})
            *to++ = value;
    }
    return f;
}

void take_node(const HeatNode& node, double eta, double s, WakeFunctions& f) {
    double* from = f.data();
    for (const double a : {1.0, 1.0 / (1.0 + eta)}) {
        const double behind = 2.0 * s - node.time, per = 2.0 * a / node.time,
                     here = 0.5 * node.weight / node.time * std::exp(-0.125 * per * behind * behind);
        for (const double value : {1.0, -per, per * per * s * s, per * per * s * (4.0 - per * s * s)})
            *from++ -= value * here;
    }
}

void parts_at(const WakeFunctions& f, const Field& field, double s, const double* cosine, const double* sine,
              double (*parts)[heat_lanes]) {
    HWY_DYNAMIC_DISPATCH(PartsAt)
    (f, KernelInternals::constants(field), field, s, cosine, sine, parts);
}

namespace {

/// s in a piece at u.
double place_of(std::size_t piece, double u, double reach) {
    const double z = 0.5 * (u + 1.0),
                 beyond = (static_cast<double>(piece) - 1.0 + z) / (NearHeat::pieces - 1),
                 root = piece == 0 ? NearHeat::first_end * z
                                   : NearHeat::first_end + (1.0 - NearHeat::first_end) * beyond;
    return 0.5 * reach * root * root;
}

/// Sets the polynomials of a piece; returns the largest error of functions that are asked for.
double fit_piece(std::span<const HeatNode> nodes, double eta, std::size_t piece, bool polar, NearHeat& heat) {
    const std::size_t terms = heat.powers.size();
    const auto at = [&](double u) {
        const double s = place_of(piece, u, heat.reach);
        WakeFunctions f = piece > 0 ? exact_functions(eta, s) : WakeFunctions{};
        for (const HeatNode& node : nodes)
            take_node(node, eta, s, f);
        return f;
    };
    double worst = 0.0;
    for (std::size_t i = 0; i < NearHeat::functions; ++i) {
        const std::vector<double> c = fourier::powers_of(terms, [&](double u) { return at(u)[i]; });
        for (std::size_t k = 0; k < terms; ++k)
            heat.powers[k][i][piece] = c[k];
    }
    for (int k = -10; k <= 10; ++k) {
        const double u = 0.1 * k;
        const WakeFunctions f = at(u);
        for (std::size_t i = 0; i < f.size(); ++i) {
            double sum = 0.0;
            for (std::size_t j = terms; j-- > 0;)
                sum = sum * u + heat.powers[j][i][piece];
            if (polar || i % 4 < 3)
                worst = std::max(worst, std::abs(sum - f[i]));
        }
    }
    return worst;
}

} // namespace

NearHeat near_heat(std::span<const HeatNode> nodes, double eta, double reach, double error, bool polar) {
    NearHeat heat{reach, {}};
    for (std::size_t terms = 4; terms <= NearHeat::most_terms; ++terms) {
        heat.powers.assign(terms, {});
        double worst = 0.0;
        for (std::size_t piece = 0; piece < NearHeat::pieces; ++piece)
            worst = std::max(worst, fit_piece(nodes, eta, piece, polar, heat));
        if (worst <= error)
            return heat;
    }
    heat.powers.clear();
    return heat;
}

void find_near(const NearSources& from, double x, double y, double distance, double number, NearSources& to) {
    to.reserve(from.count);
    HWY_DYNAMIC_DISPATCH(FindNear)(from, x, y, distance, number, to);
    const std::size_t count = to.count;
    while (to.count % heat_lanes != 0)
        to.add({x + distance, y, 1.0, 0.0}, -1.0);
    to.count = count;
}

void add_near(const KernelMedium& medium, const Field& field, const NearHeat& heat,
              const NearSources& sources, double x, double y, bool polar, std::span<double> sums) {
    HWY_DYNAMIC_DISPATCH(AddNearEither)(medium, field, heat, sources, x, y, polar, sums);
}

} // namespace rodwake::elastic
#endif
