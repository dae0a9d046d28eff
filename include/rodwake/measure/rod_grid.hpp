#pragma once
// Bins in the frame that moves and turns with a rod: the rod's centre of mass at the origin, its thin end
// towards +x. The grid covers one periodic box; middles of bins lie at whole multiples of the spacing, so
// that the axes run through middles.
//
// The grid's sides are those of the box as the rod sees it at its start (box_seen_by). A rod that heads at an
// angle to the box sees a turned rectangle: bins outside it have no beads.

#include "rodwake/measure/frame.hpp"

#include <cstddef>
#include <optional>

namespace rodwake::measure {

struct RodGrid {
    PeriodicBox box;                   ///< its sides along the rod's x and y, m; with the margin
    std::size_t columns = 0, rows = 0; ///< bins in x and in y, even
    double width = 0.0, height = 0.0;  ///< L_x/columns and L_y/rows, m
    double margin = 0.0; ///< m; around a window: bins without beads, so that opposite edges are no neighbours

    /// The even numbers of bins whose sizes are nearest to the wanted one. Throws InputError unless
    /// L/512 <= wanted <= L/4 for both sides.
    RodGrid(const PeriodicBox& box, double wanted, double margin = 0.0);
    RodGrid() = default;

    std::size_t bins() const { return columns * rows; }
    /// Middle of column k, -L_x/2 + k width (k = columns/2: 0), of row k, and of a bin.
    double x(std::size_t k) const { return middle(k, columns, width); }
    double y(std::size_t k) const { return middle(k, rows, height); }
    double x_of(std::size_t bin) const { return x(bin % columns); }
    double y_of(std::size_t bin) const { return y(bin / columns); }
    /// Bin [row y][column x] of a place in the rod's frame; what lies beyond +L_x/2 - width/2 belongs to the
    /// periodic image at -L_x/2. Nothing outside [-L_x/2 - width/2, L_x/2 + width/2]; y likewise.
    std::optional<std::size_t> bin(double x, double y) const;

    bool operator==(const RodGrid&) const = default;

private:
    static double middle(std::size_t k, std::size_t n, double spacing) {
        const std::size_t middle_bin = n / 2;
        return (static_cast<double>(k) - static_cast<double>(middle_bin)) * spacing;
    }
};

/// That of rod `rod`, with a margin around a window: a rod in its middle sees all of the window.
RodGrid grid_seen_by(std::size_t rod, const Layout& layout, double wanted);

/// Where a bead is as seen from a rod: nearest image, turned by minus the heading.
struct RelativePosition {
    double x = 0.0, y = 0.0;
};
using Seen [[deprecated("it is RelativePosition")]] = RelativePosition;
RelativePosition relative_position(const RodPosition& rod, double x, double y, const PeriodicBox& box);

} // namespace rodwake::measure
