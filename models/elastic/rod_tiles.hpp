#pragma once
// Rods sorted into compact tiles and blocks of tiles (sizes: mutual_pairs.hpp).

#include "mutual_pairs.hpp"

#include <cstdint>

namespace rodwake::elastic {

/// Numbers of the rods in an order in which each tile, and each block, lies together: halves across the
/// longer side, again and again. It depends on the places and, where these are equal, on the numbers.
std::vector<std::uint32_t> compact_order(std::span<const KernelSource> rods);

/// A circle round places.
struct Circle {
    double x, y, radius;
};
Circle circle_around(std::span<const KernelSource> rods);

} // namespace rodwake::elastic
