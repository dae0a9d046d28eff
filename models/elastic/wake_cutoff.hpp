#pragma once
// Where a source may be left out of a sum, as a rule that costs a few nanoseconds: WakeBound worked out
// ahead.

#include "mutual_pairs.hpp"
#include "rodwake/elastic/wake_bound.hpp"

#include <cstdint>

namespace rodwake::elastic {

// Rods sorted into compact tiles and blocks of tiles (sizes: mutual_pairs.hpp).

/// Numbers of the rods in an order in which each tile, and each block, lies together: halves across the
/// longer side, again and again. It depends on the places and, where these are equal, on the numbers.
std::vector<std::uint32_t> compact_order(std::span<const KernelSource> rods);

/// A circle round places.
struct Circle {
    double x, y, radius;
};
Circle circle_around(std::span<const KernelSource> rods);

/// Largest contributions that may be left out; polar only where `with_polar`.
struct Cutoff {
    double strain, polar;
    bool with_polar;
};

class WakeCutoff {
public:
    WakeCutoff(const Medium& medium, const Cutoff& cutoff);

    /// Whether the source's field is below the cutoff everywhere in the circle.
    bool skips(const KernelSource& source, const Circle& circle) const;

private:
    double inverse_xi_;
    std::vector<double>
        least_; ///< (r + x)/xi from which on all is below the cutoff, by steps of the distance
};

} // namespace rodwake::elastic
