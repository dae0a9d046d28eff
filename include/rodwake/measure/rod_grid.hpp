#pragma once
// Bins in the frame that moves and turns with a rod: the rod's centre of mass at the origin, its thin end
// towards +x. The grid covers one periodic box; middles of bins lie at whole multiples of the spacing, so
// that the axes run through middles.
//
// A rod that heads at an angle to the box sees a turned square: bins outside it have no beads.

#include "rodwake/measure/frame.hpp"

#include <cstddef>
#include <optional>

namespace rodwake::measure {

struct RodGrid {
    std::size_t n = 0;    ///< bins in x and in y, even
    double spacing = 0.0; ///< L/n, m

    /// The even number of bins whose spacing is nearest to the wanted one. Throws InputError unless
    /// L/512 <= wanted <= L/4.
    RodGrid(double box, double wanted);
    RodGrid() = default;

    std::size_t bins() const { return n * n; }
    /// Middle of column or row k, -L/2 + k spacing (k = n/2: 0).
    double middle(std::size_t k) const {
        const std::size_t middle_bin = n / 2;
        return (static_cast<double>(k) - static_cast<double>(middle_bin)) * spacing;
    }
    /// Bin [row y][column x] of a place in the rod's frame; what lies beyond +L/2 - spacing/2 belongs to the
    /// periodic image at -L/2. Nothing outside [-L/2 - spacing/2, L/2 + spacing/2].
    std::optional<std::size_t> bin(double x, double y) const;

    bool operator==(const RodGrid&) const = default;
};

/// Where a bead is as seen from a rod: nearest image, turned by minus the heading.
struct Seen {
    double x = 0.0, y = 0.0;
};
Seen seen_from(const RodPlace& rod, double x, double y, double box);

} // namespace rodwake::measure
