// One piece in each lane. Compiled once for each instruction set (foreach_target includes this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pair_pieces.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "pair_jets_inl.hpp"
#include "pair_pieces.hpp"
#include "piece_numbers_inl.hpp"
#include "turning_bound_inl.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace rodwake::rods::HWY_NAMESPACE {

constexpr double ulps = 32.0 * std::numeric_limits<double>::epsilon(); // allowed for in each defect

/// As many pieces as there are lanes.
struct LanePieces {
    V length, p[4][6];
};

/// `of(lane)` is the piece of a lane.
template<class Of>
LanePieces LoadPieces(const Of& of) {
    const Lanes d;
    LanePieces pieces;
    LaneNumbers numbers;
    const auto load = [&](const auto& number) {
        for (std::size_t lane = 0; lane < lane_count; ++lane)
            numbers[lane] = number(of(lane));
        return hn::Load(d, numbers.at);
    };
    pieces.length = load([](const Piece& piece) { return piece.length; });
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t k = 0; k < 6; ++k)
            pieces.p[i][k] = load([&](const Piece& piece) { return piece.p[i].c[k]; });
    return pieces;
}

/// Stores a struct of vectors to structs of numbers, one for each of the first lanes.
template<template<class> class Struct, class To>
void StoreEach(const Struct<V>& vectors, std::size_t count, const To& to) {
    constexpr std::size_t numbers = sizeof(Struct<double>) / sizeof(double);
    const auto* const from = reinterpret_cast<const V*>(&vectors);
    std::array<LaneNumbers, numbers> all;
    for (std::size_t k = 0; k < numbers; ++k)
        hn::Store(from[k], Lanes(), all[k].at);
    for (std::size_t lane = 0; lane < count; ++lane) {
        auto* const into = reinterpret_cast<double*>(&to(lane));
        for (std::size_t k = 0; k < numbers; ++k)
            into[k] = all[k][lane];
    }
}

/// Loads a struct of vectors; `of(lane)` is the struct of a lane.
template<template<class> class Struct, class Of>
Struct<V> LoadEach(const Of& of) {
    constexpr std::size_t numbers = sizeof(Struct<double>) / sizeof(double);
    std::array<LaneNumbers, numbers> all;
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
        const auto* const from = reinterpret_cast<const double*>(&of(lane));
        for (std::size_t k = 0; k < numbers; ++k)
            all[k][lane] = from[k];
    }
    Struct<V> vectors;
    auto* const into = reinterpret_cast<V*>(&vectors);
    for (std::size_t k = 0; k < numbers; ++k)
        into[k] = hn::Load(Lanes(), all[k].at);
    return vectors;
}

HWY_INLINE V LengthOf(V x, V y) { return hn::Sqrt(Fma(Lanes(), x, x, hn::Mul(y, y))); }

/// Bound of the change of (w+, w-) and the phases from v = 0 to |v| <= reach, as ln of 1 + the relative
/// change.
struct Wandering {
    V a[5]; ///< coefficients of v, v^2, ...

    /// Above 0, so that it can be a divisor.
    V At(V reach) const {
        V sum = hn::Mul(reach, a[4]);
        for (std::size_t k = 4; k-- > 0;)
            sum = hn::Mul(reach, hn::Add(a[k], sum));
        return hn::Max(sum, Number(1e-300));
    }
    /// A reach within `room`, near the largest. The sum has powers 1 to 5, so that a reach shorter by a
    /// factor, or longer by the fifth root of one, stays inside.
    V Reach(V room) const {
        const Lanes d;
        const V one = Number(1.0), farthest = Number(32.0);
        V reach = hn::Min(farthest, hn::Div(room, At(one)));
        reach = hn::Mul(reach, hn::Min(one, hn::Div(room, At(reach))));
        for (int k = 0; k < 2; ++k) {
            const V more = hn::Sub(hn::Div(room, At(reach)), one); // (1 + x)^(1/5) >= 1 + x/(5 + 2 x)
            reach = Fma(d, reach, hn::Div(more, Fma(d, Number(2.0), more, Number(5.0))), reach);
        }
        return hn::Min(farthest, reach);
    }
};

Wandering WanderingOf(const LanePieces& piece, V distance) {
    const Lanes d;
    const V unit = hn::Div(Number(std::numbers::sqrt2), distance);
    Wandering w;
    for (std::size_t k = 0; k < 5; ++k)
        w.a[k] = Fma(d, unit, LengthOf(piece.p[0][k + 1], piece.p[1][k + 1]),
                     hn::Add(hn::Abs(piece.p[2][k + 1]), hn::Abs(piece.p[3][k + 1])));
    return w;
}

V Excursion(const V (&p)[6], V reach) {
    const Lanes d;
    V sum = hn::Zero(d);
    for (std::size_t k = 5; k > 0; --k)
        sum = hn::Mul(reach, hn::Add(hn::Abs(p[k]), sum));
    return sum;
}

/// 4 rho^-n/(rho - 1) for the ellipse with half axes `reach` and sqrt(reach^2 - 1): error of interpolation at
/// the nodes of a function bounded by 1 there (Trefethen, theorem 8.2). At most 4, which follows from a bound
/// on the piece.
V RemainderFactor(V reach) {
    const Lanes d;
    const V one = Number(1.0);
    const V rho = hn::Add(reach, hn::Sqrt(hn::Max(hn::Zero(d), Fms(d, reach, reach, one))));
    V power = one;
    for (int k = 0; k < degree; ++k)
        power = hn::Mul(power, rho);
    const V factor = hn::Div(Number(4.0), hn::Mul(power, hn::Sub(rho, one)));
    return hn::IfThenElse(hn::Gt(reach, Number(1.02)), hn::Min(factor, Number(4.0)), Number(4.0));
}

PieceReach<V> ReachOf(const LanePieces& piece, const LaneMedium<Lanes>& medium, const BoundWeights& largest,
                      const BoundWeights& change) {
    const Lanes d;
    const V x = piece.p[0][0], y = piece.p[1][0], one = Number(1.0);
    PieceReach<V> reach;
    reach.distance = LengthOf(x, y);
    const V headings[2] = {piece.p[2][0], piece.p[3][0]}, r = hn::Mul(medium.c_shear, reach.distance);

    // s + X of each rod in the frame of the other.
    SineCosine<Lanes> n[2];
    elastic::HWY_NAMESPACE::SinCos(d, headings, n);
    V ahead[2];
    for (std::size_t rod = 0; rod < 2; ++rod) {
        const SineCosine<Lanes>& of = n[1 - rod];
        const V plain = Fma(d, x, of.cosine, hn::Mul(y, of.sine)), X = rod == 0 ? plain : hn::Neg(plain);
        const V across = Fms(d, y, of.cosine, hn::Mul(x, of.sine)), far = hn::Add(reach.distance, hn::Abs(X));
        const V near =
            hn::Div(hn::Mul(across, across), far); // r + X behind the rod, without the cancellation
        ahead[rod] = hn::Mul(medium.c_shear, hn::IfThenElse(hn::Lt(X, hn::Zero(d)), near, far));
    }

    // Bounds of the rates of turn about the piece, and how far from it they hold.
    const V width = hn::Min(SuitableWidth(r, ahead[0]), SuitableWidth(r, ahead[1]));
    const Around around = AroundOf(r, ahead, width, medium.nu);
    const V all = hn::Div(hn::Add(width, width), hn::Add(Number(2.0), width)); // below ln(1 + width)
    const V part = hn::Mul(Number(0.7), all);
    const Wandering wandering = WanderingOf(piece, reach.distance);
    const V far = wandering.Reach(all);
    reach.length = piece.length;
    reach.room = hn::Sub(all, wandering.At(one));
    const V rest = RemainderFactor(far), root2 = Number(std::numbers::sqrt2);
    const V slope_reach = wandering.Reach(part), on_piece = hn::Div(Number(4.0), reach.room);
    const V slope_rest = // within `part` the derivatives are bounded only where the piece does not leave it
        hn::IfThenElse(hn::Gt(slope_reach, Number(1.02)),
                       hn::Min(hn::Div(RemainderFactor(slope_reach), hn::Sub(all, part)), on_piece),
                       on_piece);

    // Errors of interpolation, of rates and of directions, and rounding.
    reach.missed = reach.rest[0] = hn::Zero(d);
    for (std::size_t rod = 0; rod < 2; ++rod) {
        const TurningBounds most = TurningBoundsOf(around, rod, largest, medium.nu);
        reach.rate[rod] = most.rate;
        reach.change[rod] = TurningBoundsOf(around, rod, change, medium.nu).rate;
        reach.turn[rod] = Excursion(piece.p[2 + rod], one);
        const V turned = Excursion(piece.p[2 + rod], far); // e^x - 1 <= x/(1 - x/2)
        reach.direction_rest[rod] =
            hn::Mul(hn::Mul(root2, rest), hn::Div(turned, Fma(d, Number(-0.5), turned, one)));
        reach.phase_rest[rod] = hn::Mul(most.rate, slope_rest);
        const V rounding = hn::Mul(
            Number(ulps), hn::Add(most.parts, hn::Div(hn::Add(one, hn::Abs(headings[rod])), piece.length)));
        reach.rest[1 + rod] = hn::Mul(rest, most.rate);
        reach.missed = hn::Max(reach.missed, hn::Add(reach.rest[1 + rod], reach.direction_rest[rod]));
        reach.rest[0] = hn::Add(reach.rest[0], reach.direction_rest[rod]);
        reach.rest[1 + rod] = hn::Add(reach.rest[1 + rod], rounding);
    }
    reach.missed = hn::Mul(reach.missed, piece.length);
    reach.rest[0] =
        hn::Add(reach.rest[0], hn::Mul(Number(ulps), hn::Add(one, hn::Div(reach.distance, piece.length))));
    return reach;
}

void FindReach(const elastic::Medium& medium, const PieceCouplings& couplings, std::span<ProofPiece> pieces) {
    const PairConstants c = ConstantsOf(medium, couplings.own);
    const BoundWeights largest = BoundWeightsOf(medium, couplings.largest),
                       change = BoundWeightsOf(medium, couplings.change);
    for (std::size_t at = 0; at < pieces.size(); at += lane_count) {
        const auto of = [&](std::size_t lane) -> const Piece& {
            return pieces[std::min(at + lane, pieces.size() - 1)].piece;
        };
        const PieceReach<V> reach = ReachOf(LoadPieces(of), c.medium, largest, change);
        StoreEach(reach, std::min(lane_count, pieces.size() - at),
                  [&](std::size_t lane) -> PieceReach<double>& { return pieces[at + lane].reach; });
    }
}

/// Functions that are expanded in Chebyshev polynomials.
enum SampleColumn {
    defect_column,                    ///< of x, y, theta_0, theta_1
    by_column = defect_column + 4,    ///< rates by the same
    direction_column = by_column + 8, ///< cosine and sine of both headings
    column_count = direction_column + 4
};

/// exp(h J), and h times the sum of (h J)^k/(k + 1)! times `acts`, to the sixth power. `mean` has the
/// expansions of J.
void Propagate(const Expanded (&mean)[column_count], const V (&acts)[4], V length, PieceExpansion<V>& e) {
    const Lanes d;
    V a[4][4];
    a[0][0] = a[0][1] = a[1][0] = a[1][1] = hn::Zero(d);
    for (std::size_t rod = 0; rod < 2; ++rod) {
        const V cosine = hn::Mul(length, mean[direction_column + 2 * rod].mean),
                sine = hn::Mul(length, mean[direction_column + 2 * rod + 1].mean);
        a[0][2 + rod] = rod == 0 ? hn::Neg(sine) : sine;
        a[1][2 + rod] = rod == 0 ? cosine : hn::Neg(cosine);
        for (std::size_t k = 0; k < 4; ++k)
            a[2 + rod][k] = hn::Mul(length, mean[by_column + 4 * rod + k].mean);
    }
    const auto times = [&](std::size_t i, const auto& column) HWY_ATTR {
        const V right = Fma(d, a[i][2], column(2), hn::Mul(a[i][3], column(3)));
        return i < 2 ? right : Fma(d, a[i][0], column(0), Fma(d, a[i][1], column(1), right));
    };
    constexpr int terms = 6;
    for (std::size_t column = 0; column < 4; ++column) {
        V p[4], next[4];
        for (std::size_t i = 0; i < 4; ++i)
            p[i] = Number(i == column ? 1.0 : 0.0);
        for (int k = terms; k > 0; --k) {
            RODWAKE_UNROLL
            for (std::size_t i = 0; i < 4; ++i)
                next[i] = Fma(d, Number(1.0 / k), times(i, [&](std::size_t j) HWY_ATTR { return p[j]; }),
                              Number(i == column ? 1.0 : 0.0));
            std::copy_n(next, 4, p);
        }
        for (std::size_t i = 0; i < 4; ++i)
            e.propagator[i][column] = p[i];
    }
    V s[4], next[4];
    for (std::size_t i = 0; i < 4; ++i)
        s[i] = acts[i];
    for (int k = terms; k > 0; --k) {
        for (std::size_t i = 0; i < 4; ++i)
            next[i] = Fma(d, Number(1.0 / (k + 1)), times(i, [&](std::size_t j) HWY_ATTR { return s[j]; }),
                          acts[i]);
        std::copy_n(next, 4, s);
    }
    for (std::size_t i = 0; i < 4; ++i)
        e.drift[i] = hn::Mul(length, s[i]);
}

/// Samples at the nodes. Lanes out of the range of the kernels are false.
template<bool polar>
M SamplesOf(const LanePieces& piece, const PairConstants& c, V (&samples)[column_count][nodes]) {
    const Lanes d;
    const V speed = hn::Div(Number(2.0), piece.length);
    M good = hn::Eq(hn::Zero(d), hn::Zero(d));
    for (std::size_t j = 0; j < nodes; ++j) {
        const V v = Number(node_at[j]);
        V value[4], slope[4];
        RODWAKE_UNROLL
        for (std::size_t i = 0; i < 4; ++i) {
            value[i] = piece.p[i][5];
            slope[i] = hn::Zero(d);
            RODWAKE_UNROLL
            for (std::size_t k = 1; k <= 5; ++k) { // Horner's rule and its derivative
                slope[i] = Fma(d, slope[i], v, value[i]);
                value[i] = Fma(d, value[i], v, piece.p[i][5 - k]);
            }
        }
        const Jets jets = JetsAt<polar>({value[0], value[1], {value[2], value[3]}}, c);
        good = hn::And(good, jets.good);
        const V velocity[4] = {hn::Sub(jets.n[0].cosine, jets.n[1].cosine),
                               hn::Sub(jets.n[0].sine, jets.n[1].sine), jets.rate[0], jets.rate[1]};
        RODWAKE_UNROLL
        for (std::size_t i = 0; i < 4; ++i) {
            samples[defect_column + i][j] = Fms(d, speed, slope[i], velocity[i]);
            samples[by_column + i][j] = jets.by[0][i];
            samples[by_column + 4 + i][j] = jets.by[1][i];
        }
        for (std::size_t rod = 0; rod < 2; ++rod) {
            samples[direction_column + 2 * rod][j] = jets.n[rod].cosine;
            samples[direction_column + 2 * rod + 1][j] = jets.n[rod].sine;
        }
    }
    return good;
}

/// Norms of the blocks of a Jacobian, or of the parts of an error, from its columns.
template<class Part>
HWY_INLINE BoundMatrix BlockOf(const Expanded (&all)[column_count], const Part& part) {
    const auto both = [&](std::size_t k) HWY_ATTR { return LengthOf(part(all[k]), part(all[k + 1])); };
    BoundMatrix block;
    block.of[0][0] = hn::Zero(Lanes());
    for (std::size_t rod = 0; rod < 2; ++rod) {
        const std::size_t by = by_column + 4 * rod;
        block.of[0][1 + rod] = both(direction_column + 2 * rod);
        block.of[1 + rod][0] = both(by);
        block.of[1 + rod][1] = hn::Abs(part(all[by + 2]));
        block.of[1 + rod][2] = hn::Abs(part(all[by + 3]));
    }
    return block;
}
template<class Part>
HWY_INLINE ErrorBounds ErrorsOf(const Expanded (&all)[4], const Part& part) {
    return {LengthOf(part(all[0]), part(all[1])), hn::Abs(part(all[2])), hn::Abs(part(all[3]))};
}

BoundMatrix RestOf(const PieceReach<V>& reach) {
    const V by_place = hn::Div(Number(std::numbers::sqrt2), reach.distance);
    BoundMatrix rest;
    rest.of[0][0] = hn::Zero(Lanes());
    for (std::size_t rod = 0; rod < 2; ++rod) {
        rest.of[0][1 + rod] = reach.direction_rest[rod];
        rest.of[1 + rod][0] = hn::Mul(by_place, reach.phase_rest[rod]);
        rest.of[1 + rod][1] = rest.of[1 + rod][2] = reach.phase_rest[rod];
    }
    return rest;
}

/// E = -int (defect - its mean), and J E at the nodes.
void SecondOrder(const V (&samples)[column_count][nodes], V length, const ChebyshevRows& rows,
                 V (&product)[4][nodes]) {
    const Lanes d;
    const V half = hn::Mul(Number(-0.5), length);
    for (std::size_t j = 0; j < nodes; ++j) {
        V e[4];
        for (std::size_t i = 0; i < 4; ++i) {
            const V(&defect)[nodes] = samples[defect_column + i];
            V sum = hn::Mul(Number(rows.integral[j][0]), defect[0]);
            RODWAKE_UNROLL
            for (std::size_t k = 1; k < nodes; ++k)
                sum = Fma(d, Number(rows.integral[j][k]), defect[k], sum);
            e[i] = hn::Mul(half, sum);
        }
        const auto direction = [&](std::size_t k) HWY_ATTR { return samples[direction_column + k][j]; };
        product[0][j] = Fms(d, direction(3), e[3], hn::Mul(direction(1), e[2]));
        product[1][j] = Fms(d, direction(0), e[2], hn::Mul(direction(2), e[3]));
        for (std::size_t rod = 0; rod < 2; ++rod) {
            product[2 + rod][j] = hn::Zero(d);
            for (std::size_t k = 0; k < 4; ++k)
                product[2 + rod][j] = Fma(d, samples[by_column + 4 * rod + k][j], e[k], product[2 + rod][j]);
        }
    }
}

void Store(const ErrorBounds& errors, V (&to)[3]) { std::copy_n(errors.of, 3, to); }
void Store(const BoundMatrix& block, V (&to)[3][3]) {
    for (std::size_t i = 0; i < 3; ++i)
        std::copy_n(block.of[i], 3, to[i]);
}

/// Largest image of errors of 1, with those of positions in units of the scale.
HWY_INLINE V NormOf(const BoundMatrix& a, V scale) {
    const Lanes d;
    V norm = hn::Div(hn::Add(a.of[0][1], a.of[0][2]), scale);
    for (std::size_t i = 1; i < 3; ++i)
        norm = hn::Max(norm, Fma(d, a.of[i][0], scale, hn::Add(a.of[i][1], a.of[i][2])));
    return norm;
}

/// The scale makes both kinds of error count alike: 2/scale = scale |d rate/d position|. The series of exp
/// leaves out n^7/5040 (1 + n/8 + ...), n = |h J|, which must be below 4.
M FindGrowth(const BoundMatrix& mean, const BoundMatrix& jacobian, const PieceReach<V>& reach,
             PieceExpansion<V>& e) {
    const V far = hn::Mul(Number(10.0), hn::Add(reach.distance, reach.length));
    e.scale = hn::Min(far, hn::Sqrt(hn::Div(Number(2.0), hn::Add(mean.of[1][0], mean.of[2][0]))));
    e.growth = hn::Mul(reach.length, NormOf(jacobian, e.scale));
    const V n = hn::Mul(reach.length, NormOf(mean, e.scale)), n2 = hn::Mul(n, n);
    const V seventh = hn::Mul(hn::Mul(n2, n2), hn::Mul(n2, n));
    e.truncation = hn::Mul(Number(1.0 / 2500.0), seventh);
    return hn::Lt(n, Number(4.0));
}

/// Bounds of the error (docs/numerics.md, section 4), from expansions of the samples and of J E.
void Bounds(const Expanded (&all)[column_count], const Expanded (&second)[4], const V (&acts)[4],
            const PieceReach<V>& reach, PieceExpansion<V>& e) {
    const V length = reach.length, quarter = hn::Mul(Number(0.25), length), one = Number(1.0),
            third4 = Number(4.0 / 3.0);
    const auto mean_of = [](const Expanded& of) HWY_ATTR { return of.mean; };
    const auto varies_of = [](const Expanded& of) HWY_ATTR { return of.varies; };
    const auto tail_of = [](const Expanded& of) HWY_ATTR { return of.tail; };
    Expanded first[4];
    std::copy_n(all + defect_column, 4, first);
    const BoundMatrix mean = BlockOf(all, mean_of), varies = BlockOf(all, varies_of), rest = RestOf(reach),
                      tail = BlockOf(all, tail_of);
    // T_k differs from its mean by 4/3 at most, and the integral of that stays below 1/2
    const BoundMatrix jacobian = Combined(Combined(mean, third4, varies), one, rest);
    const BoundMatrix zero = Combined(mean, Number(-1.0), mean), turned = Combined(zero, quarter, varies);
    const ErrorBounds defect = ErrorsOf(first, varies_of), e1 = Times(quarter, defect),
                      e2 = Times(quarter, ErrorsOf(second, varies_of));
    const ErrorBounds mean_defect = ErrorsOf(first, mean_of),
                      rests{reach.rest[0], reach.rest[1], reach.rest[2]};
    // the product of T_i and T_k counts once in what interpolation of J E misses if i + k is above the
    // degree: then i is 6 or more, or k above that, and orders above 6 in E come of those from 6 on in the
    // defect
    const ErrorBounds e1_tail = Times(hn::Mul(Number(1.0 / 14.0), length), ErrorsOf(first, tail_of));
    const ErrorBounds folded = Plus(Times(tail, e1), Times(jacobian, e1_tail));
    const ErrorBounds mean_acts{LengthOf(acts[0], acts[1]), hn::Abs(acts[2]), hn::Abs(acts[3])};
    M good = hn::Eq(one, one);
    const BoundMatrix inverse = SumOfPowers(turned, good);
    const ErrorBounds known =
        Plus(Plus(Times(jacobian, e2), Times(turned, mean_acts)), Plus(Plus(folded, Times(rest, e1)), rests));
    const BoundMatrix wobble =
        Times(inverse, Combined(Combined(Times(jacobian, turned), one, Times(turned, mean)), one, rest));
    const BoundMatrix grown = SumOfPowers(Combined(Combined(zero, length, mean), length, wobble), good);
    Store(mean_acts, e.mean);
    Store(Plus(e1, e2), e.swing);
    Store(turned, e.turned);
    Store(inverse, e.inverse);
    Store(wobble, e.wobble);
    Store(Times(inverse, known), e.known);
    Store(grown, e.grown);
    Store(Plus(Plus(mean_defect, Times(third4, defect)), rests), e.defect);
    for (std::size_t rod = 0; rod < 2; ++rod)
        std::copy_n(jacobian.of[1 + rod], 3, e.by[rod]);
    good = hn::And(good, FindGrowth(mean, jacobian, reach, e));
    e.growth = hn::IfThenElse(good, e.growth, Number(HUGE_VAL));
}

template<bool polar>
M ExpansionOf(const LanePieces& piece, const PieceReach<V>& reach, const PairConstants& c,
              const ChebyshevRows& rows, PieceExpansion<V>& e) {
    V samples[column_count][nodes], product[4][nodes];
    const M in_range = SamplesOf<polar>(piece, c, samples);
    SecondOrder(samples, piece.length, rows, product);
    Expanded all[column_count], second[4];
    for (std::size_t k = 0; k < column_count; ++k)
        all[k] = ExpandedFrom(samples[k], rows);
    V acts[4];
    for (std::size_t i = 0; i < 4; ++i) {
        second[i] = ExpandedFrom(product[i], rows);
        acts[i] = hn::Sub(all[i].mean, second[i].mean);
    }
    Propagate(all, acts, piece.length, e);
    Bounds(all, second, acts, reach, e);
    return in_range;
}

bool Expand(const elastic::Medium& medium, const Couplings& couplings, std::span<ProofPiece> pieces,
            std::span<const std::size_t> which) {
    static const ChebyshevRows rows;
    const Lanes d;
    const PairConstants c = ConstantsOf(medium, couplings);
    M good = hn::Eq(hn::Zero(d), hn::Zero(d));
    for (std::size_t at = 0; at < which.size(); at += lane_count) {
        const auto of = [&](std::size_t lane) -> const Piece& {
            return pieces[which[std::min(at + lane, which.size() - 1)]].piece;
        };
        const LanePieces lanes = LoadPieces(of);
        const auto reach = LoadEach<PieceReach>([&](std::size_t lane) -> const PieceReach<double>& {
            return pieces[which[std::min(at + lane, which.size() - 1)]].reach;
        });
        PieceExpansion<V> e;
        good = hn::And(good, couplings.polar() ? ExpansionOf<true>(lanes, reach, c, rows, e)
                                               : ExpansionOf<false>(lanes, reach, c, rows, e));
        StoreEach(e, std::min(lane_count, which.size() - at),
                  [&](std::size_t lane) -> PieceExpansion<double>& { return pieces[which[at + lane]].seen; });
    }
    return hn::AllTrue(d, good);
}

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::rods {

HWY_EXPORT(FindReach);
HWY_EXPORT(Expand);

void find_reach(const elastic::Medium& medium, const PieceCouplings& couplings,
                std::span<ProofPiece> pieces) {
    HWY_DYNAMIC_DISPATCH(FindReach)(medium, couplings, pieces);
}

bool expand(const elastic::Medium& medium, const Couplings& couplings, std::span<ProofPiece> pieces,
            std::span<const std::size_t> which) {
    return HWY_DYNAMIC_DISPATCH(Expand)(medium, couplings, pieces, which);
}

} // namespace rodwake::rods
#endif
