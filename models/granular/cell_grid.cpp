#include "cell_grid.hpp"

#include "periodic.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::granular {

namespace {

struct Grid {
    double box, cell;
    std::size_t side;
    std::vector<std::uint32_t> start, member; ///< members of cell c: member[start[c]] .. member[start[c + 1]]
    std::vector<std::uint32_t> cell_of;

    std::size_t place(double x) const {
        const double wrapped = x - box * std::floor(x / box);
        return std::min(side - 1, static_cast<std::size_t>(wrapped / cell));
    }
};

Grid make_grid(const Rows& position, std::size_t count, double box, double reach) {
    const double fit = std::floor(box / reach);
    // more cells than spheres would only cost memory
    const double most = std::ceil(std::sqrt(static_cast<double>(count))) + 1.0;
    const auto side = static_cast<std::size_t>(std::clamp(fit, 1.0, most));
    Grid grid{box, box / static_cast<double>(side), side, {}, {}, {}};
    grid.start.assign(side * side + 1, 0);
    grid.cell_of.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t cell = grid.place(position[4 * i + 1]) * side + grid.place(position[4 * i]);
        grid.cell_of[i] = static_cast<std::uint32_t>(cell);
        ++grid.start[cell + 1];
    }
    for (std::size_t c = 0; c < side * side; ++c)
        grid.start[c + 1] += grid.start[c];
    grid.member.resize(count);
    std::vector<std::uint32_t> next(grid.start.begin(), grid.start.end() - 1);
    for (std::size_t i = 0; i < count; ++i)
        grid.member[next[grid.cell_of[i]]++] = static_cast<std::uint32_t>(i);
    return grid;
}

/// The cell itself and those around it, each once however few there are; returns how many.
std::size_t around(const Grid& grid, std::size_t cell, std::array<std::size_t, 9>& cells) {
    const std::size_t n = grid.side, cx = cell % n, cy = cell / n;
    std::size_t count = 0;
    for (const std::size_t y : {(cy + n - 1) % n, cy, (cy + 1) % n})
        for (const std::size_t x : {(cx + n - 1) % n, cx, (cx + 1) % n})
            cells[count++] = y * n + x;
    if (n < 3) {
        std::sort(cells.begin(), cells.end());
        count = static_cast<std::size_t>(std::unique(cells.begin(), cells.end()) - cells.begin());
    }
    return count;
}

double nearest2(const Rows& position, std::size_t i, std::size_t j, double box) {
    double sum = 0.0;
    for (std::size_t k : {0u, 1u}) {
        const double d = nearest_image(position[4 * i + k] - position[4 * j + k], box);
        sum += d * d;
    }
    return sum;
}

} // namespace

void near_pairs(const Rows& position, const std::vector<double>& radius, std::size_t beads,
                const std::vector<std::uint32_t>& rod_of, double box, double skin, PairList& list) {
    list.clear();
    const std::size_t count = radius.size();
    if (count < 2)
        return;
    // The two largest may meet; most pairs are of beads, so cells fit the pair of the largest kinds present.
    const double widest = *std::max_element(radius.begin(), radius.end());
    const Grid grid = make_grid(position, count, box, 2.0 * widest + skin);
    std::array<std::size_t, 9> cells;
    std::vector<std::uint32_t> partners;
    for (std::size_t i = 0; i < count; ++i) {
        partners.clear();
        const std::size_t cell_count = around(grid, grid.cell_of[i], cells);
        for (std::size_t c = 0; c < cell_count; ++c)
            for (std::uint32_t k = grid.start[cells[c]]; k < grid.start[cells[c] + 1]; ++k) {
                const std::uint32_t j = grid.member[k];
                if (j <= i || (i >= beads && rod_of[i - beads] == rod_of[j - beads]))
                    continue;
                const double reach = radius[i] + radius[j] + skin;
                if (nearest2(position, i, j, box) < reach * reach)
                    partners.push_back(j);
            }
        std::sort(partners.begin(), partners.end());
        for (const std::uint32_t j : partners) {
            list.pairs.push_back({static_cast<std::uint32_t>(i), j});
            list.reach.push_back(radius[i] + radius[j]);
        }
    }
}

} // namespace rodwake::granular
