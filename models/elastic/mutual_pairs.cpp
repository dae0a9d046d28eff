// Sums over all pairs of rods, block by block. Compiled once for each instruction set (foreach_target
// includes this file again).
//
// Lane i of two tiles meets lane i + k (mod 16) of the other, k from 0 to 15, so each rod of either gets its
// sixteen contributions in the order of k, however many lanes a vector has. The second tile stands twice in
// memory, so that i + k needs no wrapping.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mutual_pairs.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "lab_parts_inl.hpp"
#include "mutual_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

/// A tile, twice. Lanes without a rod have no place (NaN) and give nothing.
template<class K>
struct Tile {
    double x[2 * tile_rods], y[2 * tile_rods];
    typename K::Real cosine[2 * tile_rods], sine[2 * tile_rods];
    const KernelSource* rods;
};

template<class K>
Tile<K> TileOf(std::span<const KernelSource> rods) {
    Tile<K> tile;
    tile.rods = rods.data();
    for (std::size_t i = 0; i < 2 * tile_rods; ++i) {
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        const std::size_t rod = i % tile_rods;
        const KernelSource source = rod < rods.size() ? rods[rod] : KernelSource{none, none, 1.0, 0.0};
        tile.x[i] = source.x;
        tile.y[i] = source.y;
        tile.cosine[i] = static_cast<typename K::Real>(source.cosine);
        tile.sine[i] = static_cast<typename K::Real>(source.sine);
    }
    return tile;
}

/// Sums of a tile in the working precision; those of the second tile of a pair stand twice, as it does.
template<class K>
struct TileSums {
    HWY_ALIGN typename K::Real part[all_parts][2 * tile_rods] = {};
};

/// Lanes of a step: rods i, i + 1, ... of tile a and j, j + 1, ... of tile b.
template<class K>
struct TileStep {
    const Tile<K>&a, &b;
    std::size_t i, j;
};

/// The exact field in the lanes that the kernel cannot do: of b's rods at a's if `at_a`, else of a's at b's.
template<bool polar, class K>
HWY_NOINLINE void ReplacePairs(PartVectors<K>& parts, hn::Mask<typename K::Lanes> in_range,
                               const Field& field, const TileStep<K>& step, bool at_a) {
    ReplaceLanes<polar, K>(parts, in_range, [&](std::size_t lane, double* exact) {
        const std::size_t i = step.i + lane, j = step.j + lane;
        if (std::isnan(step.a.x[i]) || std::isnan(step.b.x[j]))
            return;
        const KernelSource &a = step.a.rods[i % tile_rods], &b = step.b.rods[j % tile_rods];
        const KernelSource &source = at_a ? b : a, &target = at_a ? a : b;
        exact_parts(field, source, target.x, target.y, polar, exact);
    });
}

template<bool polar, class K>
HWY_INLINE void AddParts(const PartVectors<K>& parts, TileSums<K>& sums, std::size_t at) {
    const typename K::Lanes d;
    RODWAKE_UNROLL
    for (int k = 0; k < (polar ? all_parts : strain_parts); ++k) {
        typename K::Real* const to = sums.part[k] + at;
        hn::StoreU(hn::Add(hn::LoadU(d, to), parts.part[k]), d, to);
    }
}

/// What a vector of rods of a and one of b give each other: K0 and K1 once for both.
template<bool polar, class K>
HWY_INLINE void AddStep(const Setting<K>& with, const TileStep<K>& step, TileSums<K>& sum_a,
                        TileSums<K>& sum_b) {
    const typename K::Lanes d;
    using V = typename K::V;
    const Tile<K>&a = step.a, &b = step.b;
    const V x = Offset(LoadCoordinates<K>(a.x + step.i), LoadCoordinates<K>(b.x + step.j), with.c_shear),
            y = Offset(LoadCoordinates<K>(a.y + step.i), LoadCoordinates<K>(b.y + step.j), with.c_shear);
    const V cos_a = hn::LoadU(d, a.cosine + step.i), sin_a = hn::LoadU(d, a.sine + step.i),
            cos_b = hn::LoadU(d, b.cosine + step.j), sin_b = hn::LoadU(d, b.sine + step.j);
    const V distance[1] = {hn::Sqrt(Fma(d, x, x, hn::Mul(y, y)))};
    Radial<typename K::Lanes> radial[1];
    RadialAt<K::shape>(d, with.table, distance, with.medium, radial);
    // a's rods as b's see them, and b's as a's do
    const V X[2] = {Fma(d, cos_b, x, hn::Mul(sin_b, y)), hn::Neg(Fma(d, cos_a, x, hn::Mul(sin_a, y)))};
    const V Y[2] = {Fms(d, cos_b, y, hn::Mul(sin_b, x)), Fms(d, sin_a, x, hn::Mul(cos_a, y))};
    WakeLanes<typename K::Lanes> wake[2];
    WakeAt<polar, K::shape>(d, X, Y, {&radial[0], &radial[0]}, with.medium, wake);
    PartVectors<K> at_a = LabParts<polar>(wake[0], cos_b, sin_b, with.unit),
                   at_b = LabParts<polar>(wake[1], cos_a, sin_a, with.unit);
    if (HWY_UNLIKELY(!hn::AllTrue(d, radial[0].in_range))) {
        ReplacePairs<polar, K>(at_a, radial[0].in_range, *with.field, step, true);
        ReplacePairs<polar, K>(at_b, radial[0].in_range, *with.field, step, false);
    }
    AddParts<polar, K>(at_a, sum_a, step.i);
    AddParts<polar, K>(at_b, sum_b, step.j);
}

/// Adds both halves of a tile's sums to those of its block, in double.
template<bool polar, class K>
HWY_INLINE void Flush(const TileSums<K>& sums, RodSums& block, std::size_t first) {
    for (int k = 0; k < (polar ? all_parts : strain_parts); ++k)
        for (std::size_t i = 0; i < tile_rods; ++i)
            block.part[k][first + i] +=
                static_cast<double>(sums.part[k][i]) + static_cast<double>(sums.part[k][i + tile_rods]);
}

/// Every rod of a with every rod of another tile b.
template<bool polar, class K>
HWY_INLINE void AddTiles(const Setting<K>& with, const Tile<K>& a, const Tile<K>& b, TileSums<K>& sum_a,
                         TileSums<K>& sum_b) {
    for (std::size_t k = 0; k < tile_rods; ++k)
        for (std::size_t i = 0; i < tile_rods; i += K::lane_count)
            AddStep<polar, K>(with, {a, b, i, i + k}, sum_a, sum_b);
}

/// Every two rods of a tile. At half a turn each two would meet twice: the second half stays away. One sum
/// for both roles would be added to in an order that depends on the lanes.
template<bool polar, class K>
HWY_INLINE void AddTile(const Setting<K>& with, const Tile<K>& tile, TileSums<K>& first,
                        TileSums<K>& second) {
    constexpr std::size_t half_turn = tile_rods / 2;
    for (std::size_t k = 1; k < half_turn; ++k)
        for (std::size_t i = 0; i < tile_rods; i += K::lane_count)
            AddStep<polar, K>(with, {tile, tile, i, i + k}, first, second);
    Tile<K> half = tile;
    std::fill_n(half.x + half_turn, half_turn, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < half_turn; i += K::lane_count)
        AddStep<polar, K>(with, {half, tile, i, i + half_turn}, first, second);
}

template<class K>
std::size_t MakeTiles(std::span<const KernelSource> rods, Tile<K> (&tiles)[block_tiles]) {
    std::size_t count = 0;
    for (std::size_t first = 0; first < rods.size(); first += tile_rods)
        tiles[count++] = TileOf<K>(rods.subspan(first, std::min(tile_rods, rods.size() - first)));
    return count;
}

template<bool polar, class K>
void AddWithin(const Setting<K>& with, const BlockPair& pair) {
    Tile<K> tiles[block_tiles];
    const std::size_t count = MakeTiles<K>(pair.a, tiles);
    for (std::size_t i = 0; i < count; ++i) {
        TileSums<K> first, second;
        AddTile<polar, K>(with, tiles[i], first, second);
        Flush<polar, K>(first, *pair.sum_a, i * tile_rods);
        Flush<polar, K>(second, *pair.sum_a, i * tile_rods);
        for (std::size_t j = i + 1; j < count; ++j) {
            TileSums<K> sum_i, sum_j;
            AddTiles<polar, K>(with, tiles[i], tiles[j], sum_i, sum_j);
            Flush<polar, K>(sum_i, *pair.sum_a, i * tile_rods);
            Flush<polar, K>(sum_j, *pair.sum_a, j * tile_rods);
        }
    }
}

template<bool polar, class K>
void AddBetween(const Setting<K>& with, const BlockPair& pair) {
    Tile<K> a[block_tiles], b[block_tiles];
    const std::size_t count_a = MakeTiles<K>(pair.a, a), count_b = MakeTiles<K>(pair.b, b);
    for (std::size_t i = 0; i < count_a; ++i)
        for (std::size_t j = 0; j < count_b; ++j) {
            TileSums<K> sum_i, sum_j;
            AddTiles<polar, K>(with, a[i], b[j], sum_i, sum_j);
            Flush<polar, K>(sum_i, *pair.sum_a, i * tile_rods);
            Flush<polar, K>(sum_j, *pair.sum_b, j * tile_rods);
        }
}

template<bool polar, class K>
HWY_NOINLINE void AddPairs(const KernelMedium& medium, const Field& field, const BlockPair& pair) {
    const Setting<K> with = SettingOf<K>(medium, field);
    if (pair.b.empty())
        AddWithin<polar, K>(with, pair);
    else
        AddBetween<polar, K>(with, pair);
}

template<class K>
void AddEither(const KernelMedium& medium, const Field& field, bool polar, const BlockPair& pair) {
    if (polar)
        AddPairs<true, K>(medium, field, pair);
    else
        AddPairs<false, K>(medium, field, pair);
}

void AddBlockPair(const KernelMedium& medium, const Field& field, Accuracy accuracy, bool polar,
                  const BlockPair& pair) {
    switch (accuracy) {
    case Accuracy::full:
        return AddEither<FullKind>(medium, field, polar, pair);
    case Accuracy::fine:
        return AddEither<FineKind>(medium, field, polar, pair);
    case Accuracy::single:
        return AddEither<SingleKind>(medium, field, polar, pair);
    }
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::elastic {

HWY_EXPORT(AddBlockPair);

void add_block_pair(const KernelMedium& medium, const Field& field, Accuracy accuracy, bool polar,
                    const BlockPair& pair) {
    HWY_DYNAMIC_DISPATCH(AddBlockPair)(medium, field, accuracy, polar, pair);
}

} // namespace rodwake::elastic
#endif
