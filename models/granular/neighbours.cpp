#include "neighbours.hpp"

#include "rodwake/core/cell_list.hpp"
#include "rodwake/core/periodic.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::granular {

namespace {

double square_in_plan(double dx, double dy, const PeriodicBox& box) {
    dx = nearest_image_rounded(dx, box.x);
    dy = nearest_image_rounded(dy, box.y);
    return dx * dx + dy * dy;
}

/// In an order that decides how beads are moved apart: that of the cells.
void bead_pairs(const CellList& cells, const PeriodicBox& box, double range, std::vector<Near>& pairs) {
    const auto &x = cells.x(), &y = cells.y();
    cells.pairs([&](std::size_t p, std::size_t q) {
        if (square_in_plan(x[p] - x[q], y[p] - y[q], box) < range * range)
            pairs.push_back({static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(q)});
    });
}

/// Cells along one side that a disc may reach into.
struct Span {
    std::ptrdiff_t first, count;
};

Span span_of(std::size_t at, std::size_t cells, double range_in_cells) {
    const auto all = static_cast<std::ptrdiff_t>(cells);
    const auto wide = std::min(static_cast<std::ptrdiff_t>(std::ceil(range_in_cells)), all);
    const std::ptrdiff_t count = std::min(2 * wide + 1, all);
    return {static_cast<std::ptrdiff_t>(at) - count / 2, count};
}

void rod_pairs(const CellList& cells, const Room& room, double skin, std::vector<Near>& pairs) {
    for (std::size_t k = 0; k < room.rods.size(); ++k) {
        const Disc& disc = room.rods[k];
        const double range = disc.radius + room.radius + skin;
        const Span columns = span_of(cells.column(disc.x), cells.columns(), range / cells.width()),
                   rows = span_of(cells.row(disc.y), cells.rows(), range / cells.height());
        for (std::ptrdiff_t i = 0; i < columns.count; ++i)
            for (std::ptrdiff_t j = 0; j < rows.count; ++j)
                cells.in_cell(columns.first + i, rows.first + j, [&](std::size_t p) {
                    if (square_in_plan(cells.x()[p] - disc.x, cells.y()[p] - disc.y, room.box) <
                        range * range)
                        pairs.push_back({static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(k)});
                });
    }
}

} // namespace

Neighbours neighbours(const Places& places, const Room& room, double skin) {
    const double range = 2.0 * room.radius + skin;
    const CellList cells(places.x, places.y, room.box, range);
    Neighbours found;
    found.order = cells.member();
    bead_pairs(cells, room.box, range, found.beads);
    rod_pairs(cells, room, skin, found.rods);
    return found;
}

} // namespace rodwake::granular
