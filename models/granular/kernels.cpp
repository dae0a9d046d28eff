// Compiled once for each instruction set (foreach_target includes this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "kernels.hpp"
#include "rodwake/core/repeatable_math.hpp"
#include "rodwake/granular/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace rodwake::granular::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#undef RODWAKE_ROWS
// One body or two bodies a vector; instruction sets with vectors of two doubles take the plain loops.
#if HWY_MAX_BYTES >= 32
#define RODWAKE_ROWS 1
#else
#define RODWAKE_ROWS 0
#endif

void DriftOne(double* x, double* v, const Drift& d, BodyRange& range) {
    range.include(v);
    // adding nothing turns -0 into 0, as the vectors do
    for (int k = 0; k < 3; ++k) {
        x[k] = x[k] + v[k] * d.step + (k == 2 ? -d.gravity * d.step * d.step / 2.0 : 0.0);
        v[k] += k == 2 ? -d.gravity * d.step : 0.0;
    }
}

template<bool own>
bool Outside(const double* x, const Drift& d) {
    const double radius = own ? x[3] : 0.0;
    return !(x[2] - radius > d.lowest && x[2] + radius < d.highest &&
             std::abs(x[0]) + std::abs(x[1]) < 1e300);
}

template<bool own>
void DriftEach(double* position, double* velocity, std::size_t begin, std::size_t end, const Drift& d,
               BodyRange& range, std::vector<std::uint32_t>& out) {
    std::size_t i = begin;
#if RODWAKE_ROWS
    // as many beads at a time as fit into a vector: one or two
    const hn::CappedTag<double, 8> lanes;
    constexpr std::size_t beads = hn::MaxLanes(lanes) / 4;
    const double inf = std::numeric_limits<double>::infinity(), far = 1e300;
    const double fall_z = -d.gravity * d.step * d.step / 2.0, slow_z = -d.gravity * d.step;
    alignas(64) const double fall[8] = {0.0, 0.0, fall_z, 0.0, 0.0, 0.0, fall_z, 0.0};
    alignas(64) const double slow[8] = {0.0, 0.0, slow_z, 0.0, 0.0, 0.0, slow_z, 0.0};
    alignas(64) const double low[8] = {-far, -far, d.lowest, -inf, -far, -far, d.lowest, -inf};
    alignas(64) const double high[8] = {far, far, d.highest, inf, far, far, d.highest, inf};
    const auto vfall = hn::Load(lanes, fall), vslow = hn::Load(lanes, slow), vlow = hn::Load(lanes, low),
               vhigh = hn::Load(lanes, high), step = hn::Set(lanes, d.step);
    alignas(64) const double height[8] = {0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    const auto of_height = hn::Gt(hn::Load(lanes, height), hn::Zero(lanes));
    auto least = hn::Set(lanes, inf), most = hn::Set(lanes, -inf);
    for (; i + beads <= end; i += beads) {
        double *p = position + 4 * i, *q = velocity + 4 * i;
        const auto v = hn::LoadU(lanes, q);
        const auto x = hn::Add(hn::Add(hn::LoadU(lanes, p), hn::Mul(v, step)), vfall);
        least = hn::Min(least, v);
        most = hn::Max(most, v);
        hn::StoreU(x, lanes, p);
        hn::StoreU(hn::Add(v, vslow), lanes, q);
        auto inside = hn::And(hn::Gt(x, vlow), hn::Lt(x, vhigh));
        if constexpr (own) { // z and the radius behind it change places
            const auto radius = hn::IfThenElseZero(of_height, hn::Reverse2(lanes, x));
            inside = hn::And(hn::Gt(hn::Sub(x, radius), vlow), hn::Lt(hn::Add(x, radius), vhigh));
        }
        if (HWY_UNLIKELY(!hn::AllTrue(lanes, inside)))
            for (std::size_t k = i; k < i + beads; ++k)
                if (Outside<own>(position + 4 * k, d))
                    out.push_back(static_cast<std::uint32_t>(k));
    }
    alignas(64) double lowest[8], highest[8];
    hn::Store(least, lanes, lowest);
    hn::Store(most, lanes, highest);
    for (std::size_t k = 0; k < beads && i > begin; ++k) { // none seen: infinities
        range.include(lowest + 4 * k);
        range.include(highest + 4 * k);
    }
#endif
    for (; i < end; ++i) {
        DriftOne(position + 4 * i, velocity + 4 * i, d, range);
        if (Outside<own>(position + 4 * i, d))
            out.push_back(static_cast<std::uint32_t>(i));
    }
}

void DriftBeads(double* position, double* velocity, std::size_t begin, std::size_t end, const Drift& d,
                BodyRange& range, std::vector<std::uint32_t>& out) {
    if (d.own_radii)
        DriftEach<true>(position, velocity, begin, end, d, range, out);
    else
        DriftEach<false>(position, velocity, begin, end, d, range, out);
}

/// Squared distance in the plane and height difference of a pair, the nearest image.
struct SquaredSeparation {
    double flat2, height;
};

SquaredSeparation Separate(const double* position, const Pair& pair, const PeriodicBox& box) {
    const double *a = position + 4 * std::size_t{pair.first}, *b = position + 4 * std::size_t{pair.second};
    const double x = nearest_image_rounded(a[0] - b[0], box.x), y = nearest_image_rounded(a[1] - b[1], box.y);
    return {x * x + y * y, a[2] - b[2]};
}

#if RODWAKE_ROWS
using Row = hn::FixedTag<double, 4>;
// Pairs at a time: as many as fit into a vector, four or eight.
using Lanes = hn::CappedTag<double, 8>;
using V = hn::Vec<Lanes>;

struct BoxLanes {
    V x, y, per_x, per_y;
};

BoxLanes LanesOf(const PeriodicBox& box) {
    const Lanes lanes;
    return {hn::Set(lanes, box.x), hn::Set(lanes, box.y), hn::Set(lanes, 1.0 / box.x),
            hn::Set(lanes, 1.0 / box.y)};
}

/// x, y and z of four rows.
struct FourRows {
    hn::Vec<Row> x, y, z;
};

HWY_INLINE FourRows Difference(const double* HWY_RESTRICT position, const Pair* HWY_RESTRICT pairs) {
    const Row row;
    const auto difference = [&](int k) HWY_ATTR {
        return hn::Sub(hn::LoadU(row, position + 4 * std::size_t{pairs[k].first}),
                       hn::LoadU(row, position + 4 * std::size_t{pairs[k].second}));
    };
    const auto r0 = difference(0), r1 = difference(1), r2 = difference(2), r3 = difference(3);
    const auto xz01 = hn::InterleaveLower(row, r0, r1), xz23 = hn::InterleaveLower(row, r2, r3);
    const auto y01 = hn::InterleaveUpper(row, r0, r1), y23 = hn::InterleaveUpper(row, r2, r3);
    return {hn::ConcatLowerLower(row, xz23, xz01), hn::ConcatLowerLower(row, y23, y01),
            hn::ConcatUpperUpper(row, xz23, xz01)};
}

/// The same for as many pairs as fit into a vector.
HWY_INLINE void SeparateSome(const double* HWY_RESTRICT position, const Pair* HWY_RESTRICT pairs,
                             const BoxLanes& box, V& flat2, V& height) {
    FourRows first = Difference(position, pairs);
#if HWY_MAX_BYTES >= 64
    const Lanes lanes;
    const FourRows second = Difference(position, pairs + 4);
    V x = hn::Combine(lanes, second.x, first.x), y = hn::Combine(lanes, second.y, first.y);
    height = hn::Combine(lanes, second.z, first.z);
#else
    V x = first.x, y = first.y;
    height = first.z;
#endif
    x = hn::Sub(x, hn::Mul(box.x, hn::Round(hn::Mul(x, box.per_x))));
    y = hn::Sub(y, hn::Mul(box.y, hn::Round(hn::Mul(y, box.per_y))));
    flat2 = hn::Add(hn::Mul(x, x), hn::Mul(y, y));
}

std::uint32_t Bits(hn::Mask<Lanes> mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(Lanes(), mask, bytes);
    return bytes[0] & ((1u << hn::MaxLanes(Lanes())) - 1u);
}
#endif

/// Calls the test on eight pairs at a time and then on the rest, and keeps the indices that pass. Written
/// without branches on the answer, which nobody can predict.
template<class Some, class One>
HWY_INLINE std::size_t Select(std::size_t begin, std::size_t end, std::uint32_t* HWY_RESTRICT out,
                              const Some& some, const One& one) {
    std::size_t k = begin, count = 0;
#if RODWAKE_ROWS
    for (; k + 8 <= end; k += 8) {
        std::uint32_t bits = 0; // of two independent fours, which hide each other's latency, or of one eight
        for (std::size_t lane = 0; lane < 8; lane += hn::MaxLanes(Lanes()))
            bits |= some(k + lane) << lane;
        if (bits == 0)
            continue;
        for (std::uint32_t lane = 0; lane < 8; ++lane) {
            out[count] = static_cast<std::uint32_t>(k) + lane;
            count += (bits >> lane) & 1u;
        }
    }
#else
    (void)some;
#endif
    for (; k < end; ++k) {
        out[count] = static_cast<std::uint32_t>(k);
        count += one(k) ? 1 : 0;
    }
    return count;
}

std::size_t OverlappingPairs(const double* position, const PairList& list, std::size_t begin, std::size_t end,
                             const PeriodicBox& box, std::uint32_t* found) {
    const auto one = [&](std::size_t k) {
        const SquaredSeparation s = Separate(position, list.pairs[k], box);
        return s.flat2 + s.height * s.height < list.reach_of(k) * list.reach_of(k);
    };
#if RODWAKE_ROWS
    const Lanes d;
    const BoxLanes lanes = LanesOf(box);
    const auto test = [&](const auto& reach_of) HWY_ATTR {
        const auto some = [&](std::size_t k) HWY_ATTR {
            V flat2, height;
            SeparateSome(position, &list.pairs[k], lanes, flat2, height);
            const V reach = reach_of(k);
            return Bits(hn::Lt(hn::Add(flat2, hn::Mul(height, height)), hn::Mul(reach, reach)));
        };
        return Select(begin, end, found, some, one);
    };
    if (list.reach.empty())
        return test([v = hn::Set(d, list.common)](std::size_t) HWY_ATTR { return v; });
    return test([&](std::size_t k) HWY_ATTR { return hn::LoadU(d, &list.reach[k]); });
#else
    return Select(begin, end, found, 0, one);
#endif
}

std::size_t PairsWithinReach(const double* position, const PairList& list, std::size_t begin, std::size_t end,
                             const PeriodicBox& box, double allowance, std::uint32_t* found) {
    const auto one = [&](std::size_t k) {
        const double reach = list.reach_of(k) + allowance;
        return Separate(position, list.pairs[k], box).flat2 < reach * reach;
    };
#if RODWAKE_ROWS
    const Lanes d;
    const BoxLanes lanes = LanesOf(box);
    const V common = hn::Set(d, list.common);
    const auto some = [&](std::size_t k) HWY_ATTR {
        V flat2, height;
        SeparateSome(position, &list.pairs[k], lanes, flat2, height);
        const V touching = list.reach.empty() ? common : hn::LoadU(d, &list.reach[k]);
        const V reach = hn::Add(touching, hn::Set(d, allowance));
        return Bits(hn::Lt(flat2, hn::Mul(reach, reach)));
    };
    return Select(begin, end, found, some, one);
#else
    return Select(begin, end, found, 0, one);
#endif
}

double FurthestSquared(const double* position, const double* before, std::size_t rows) {
    double furthest = 0.0;
    std::size_t i = 0;
#if RODWAKE_ROWS
    const Row row;
    auto most = hn::Zero(row);
    for (; i + 2 <= rows; i += 2) {
        const auto d0 = hn::Sub(hn::LoadU(row, position + 4 * i), hn::LoadU(row, before + 4 * i)),
                   d1 = hn::Sub(hn::LoadU(row, position + 4 * i + 4), hn::LoadU(row, before + 4 * i + 4));
        const auto x = hn::InterleaveLower(row, d0, d1), y = hn::InterleaveUpper(row, d0, d1);
        most = hn::Max(most, hn::ConcatLowerLower(row, hn::Zero(row), hn::Add(hn::Mul(x, x), hn::Mul(y, y))));
    }
    furthest = hn::GetLane(hn::MaxOfLanes(row, most));
#endif
    for (; i < rows; ++i) {
        const double x = position[4 * i] - before[4 * i], y = position[4 * i + 1] - before[4 * i + 1];
        furthest = std::max(furthest, x * x + y * y);
    }
    return furthest;
}

const char* Target() { return hwy::TargetName(HWY_TARGET); }

void SeriesProduct(const double* a, int order, const double* b, double* product) {
    const hn::CappedTag<double, 8> lanes;
    for (int k = 0; k < product_lanes; k += static_cast<int>(hn::Lanes(lanes))) {
        auto sum = hn::Zero(lanes);
        for (int i = 0; i <= order; ++i)
            sum = hn::Add(sum, hn::Mul(hn::Set(lanes, a[i]), hn::LoadU(lanes, b + k - i)));
        hn::StoreU(sum, lanes, product + k);
    }
}

} // namespace rodwake::granular::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::granular {

HWY_EXPORT(DriftBeads);
HWY_EXPORT(OverlappingPairs);
HWY_EXPORT(PairsWithinReach);
HWY_EXPORT(FurthestSquared);
HWY_EXPORT(SeriesProduct);
HWY_EXPORT(Target);

BodyRange BodyRange::empty() {
    const double inf = std::numeric_limits<double>::infinity();
    return {{inf, inf, inf, inf}, {-inf, -inf, -inf, -inf}};
}

void BodyRange::include(const BodyRange& other) {
    for (int k = 0; k < 4; ++k) {
        low[k] = std::min(low[k], other.low[k]);
        high[k] = std::max(high[k], other.high[k]);
    }
}

void BodyRange::include(const double* row) {
    for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], row[k]);
        high[k] = std::max(high[k], row[k]);
    }
}

double BodyRange::fastest_in_plane() const {
    const auto largest = [this](int k) { return std::max({-low[k], high[k], 0.0}); };
    return repeatable::length(largest(0), largest(1));
}

void PairList::clear() {
    pairs.clear();
    reach.clear();
}

void PairList::resize(std::size_t count) {
    pairs.resize(count);
    reach.resize(common > 0.0 ? 0 : count);
}

std::vector<std::size_t> gather(const std::vector<PairList>& parts, ThreadPool& team, PairList& list) {
    std::vector<std::size_t> begin(parts.size() + 1, 0);
    for (std::size_t c = 0; c < parts.size(); ++c)
        begin[c + 1] = begin[c] + parts[c].size();
    list.resize(begin.back());
    team.run(parts.size(), [&](std::size_t c) {
        const auto at = static_cast<std::ptrdiff_t>(begin[c]);
        std::ranges::copy(parts[c].pairs, list.pairs.begin() + at);
        std::ranges::copy(parts[c].reach, list.reach.begin() + at);
    });
    return begin;
}

void drift(double* position, double* velocity, std::size_t begin, std::size_t end, const Drift& d,
           BodyRange& velocities, std::vector<std::uint32_t>& out) {
    HWY_DYNAMIC_DISPATCH(DriftBeads)(position, velocity, begin, end, d, velocities, out);
}

std::size_t overlapping(const double* position, const PairList& list, std::size_t begin, std::size_t end,
                        const PeriodicBox& box, std::uint32_t* found) {
    return HWY_DYNAMIC_DISPATCH(OverlappingPairs)(position, list, begin, end, box, found);
}

std::size_t within_reach(const double* position, const PairList& list, std::size_t begin, std::size_t end,
                         const PeriodicBox& box, double allowance, std::uint32_t* found) {
    return HWY_DYNAMIC_DISPATCH(PairsWithinReach)(position, list, begin, end, box, allowance, found);
}

double furthest_moved(const Rows& position, const Rows& before, std::size_t begin, std::size_t end) {
    return std::sqrt(HWY_DYNAMIC_DISPATCH(FurthestSquared)(position.data() + 4 * begin,
                                                           before.data() + 4 * begin, end - begin));
}

void series_product(const double* a, int order, const double* b, double* product) {
    HWY_DYNAMIC_DISPATCH(SeriesProduct)(a, order, b, product);
}

const char* vector_target() { return HWY_DYNAMIC_DISPATCH(Target)(); }

} // namespace rodwake::granular
#endif
