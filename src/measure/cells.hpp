#pragma once
// Pairs nearer than a cut-off in the periodic box, found with square cells at least as wide.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rodwake::measure {

/// A difference of two places in [0, box) to the nearest image.
inline double nearest_of_two(double difference, double box) {
    const double half = 0.5 * box;
    return difference > half ? difference - box : difference < -half ? difference + box : difference;
}

/// Beads sorted by cells: those of cell c are bead[start[c]] .. bead[start[c + 1]], with their places.
struct Cells {
    std::size_t side = 0; ///< at least 3, or 1: one cell of all
    std::vector<std::uint32_t> start, bead;
    std::vector<double> x, y;
};
Cells sort_into_cells(const std::vector<double>& x, const std::vector<double>& y, double box, double cutoff);

/// Calls see(i, j, dx, dy) once for each pair of beads apart by less than the cut-off, but not by 0; dx, dy
/// lead from i to j. The order depends on the places alone.
template<class See>
void for_near_pairs(const std::vector<double>& x, const std::vector<double>& y, double box, double cutoff,
                    See&& see) {
    const Cells cells = sort_into_cells(x, y, box, cutoff);
    const std::size_t n = cells.side;
    const auto look = [&](std::size_t p, std::size_t from, std::size_t to) {
        for (std::size_t q = from; q < to; ++q) {
            const double dx = nearest_of_two(cells.x[q] - cells.x[p], box);
            const double dy = nearest_of_two(cells.y[q] - cells.y[p], box);
            const double r2 = dx * dx + dy * dy;
            if (r2 < cutoff * cutoff && r2 > 0.0)
                see(std::size_t{cells.bead[p]}, std::size_t{cells.bead[q]}, dx, dy);
        }
    };
    for (std::size_t row = 0; row < n; ++row)
        for (std::size_t column = 0; column < n; ++column) {
            const std::size_t cell = row * n + column, right = (column + 1) % n, left = (column + n - 1) % n;
            const std::size_t below = (row + 1) % n * n;
            for (std::size_t p = cells.start[cell]; p < cells.start[cell + 1]; ++p) {
                look(p, p + 1, cells.start[cell + 1]);
                if (n == 1)
                    continue;
                for (const std::size_t other : {row * n + right, below + left, below + column, below + right})
                    look(p, cells.start[other], cells.start[other + 1]);
            }
        }
}

} // namespace rodwake::measure
