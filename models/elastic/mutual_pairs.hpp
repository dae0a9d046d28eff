#pragma once
// What the loops over all pairs (mutual_pairs.cpp) and their front (mutual_wakes.cpp) pass each other.

#include "wake_kernel.hpp"

#include <array>
#include <vector>

namespace rodwake::elastic {

/// Rods whose lanes go together: a tile. Sums are added up tile by tile in this order, whatever the lanes.
inline constexpr std::size_t tile_rods = 16;
/// Tiles of a block, the unit of work of a thread.
inline constexpr std::size_t block_tiles = 8, block_rods = block_tiles * tile_rods;

/// Sums of the rods of a block, part by part; the polar parts are left alone unless asked for.
struct RodSums {
    std::array<std::array<double, block_rods>, all_parts> part{};
};

/// Every two rods of block `a` and block `b`, and where to add what they give each other. If b has no rods:
/// every two of a.
struct BlockPair {
    std::span<const KernelSource> a, b; ///< block_rods at most
    RodSums *sum_a, *sum_b;
};

/// Throws InputError for two rods at one place.
void add_block_pair(const KernelMedium& medium, const Field& field, Accuracy accuracy, bool polar,
                    const BlockPair& pair);

} // namespace rodwake::elastic
