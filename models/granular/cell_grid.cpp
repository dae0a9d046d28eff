#include "cell_grid.hpp"

#include "rodwake/core/cell_list.hpp"

#include <algorithm>

namespace rodwake::granular {

namespace {

constexpr std::size_t spheres_a_task = 2048; // spheres a task; does not change results

/// Columns of the packed rows.
std::vector<double> column(const Rows& position, std::size_t count, std::size_t k) {
    std::vector<double> out(count);
    for (std::size_t i = 0; i < count; ++i)
        out[i] = position[4 * i + k];
    return out;
}

/// The pairs whose first sphere is one of [begin, end).
void pairs_of(const Bodies& bodies, const CellList& cells, const PeriodicBox& box, double skin,
              std::size_t begin, std::size_t end, PairList& found) {
    found.clear();
    std::vector<std::uint32_t> partners;
    for (std::size_t i = begin; i < end; ++i) {
        const double x = bodies.position[4 * i], y = bodies.position[4 * i + 1],
                     radius = bodies.radius[i] + skin;
        partners.clear();
        cells.around(cells.column(x), cells.row(y), [&](std::size_t k) {
            const std::uint32_t j = cells.member()[k];
            if (j <= i)
                return;
            const double dx = nearest_image_rounded(x - cells.x()[k], box.x),
                         dy = nearest_image_rounded(y - cells.y()[k], box.y),
                         reach = radius + bodies.radius[j];
            if (dx * dx + dy * dy < reach * reach && !bodies.same_rod(i, j))
                partners.push_back(j);
        });
        std::sort(partners.begin(), partners.end());
        for (const std::uint32_t j : partners) {
            found.pairs.push_back({static_cast<std::uint32_t>(i), j});
            found.reach.push_back(bodies.radius[i] + bodies.radius[j]);
        }
    }
}

} // namespace

void near_pairs(const Bodies& bodies, const PeriodicBox& box, double skin, Team& team, PairList& list) {
    list.clear();
    const std::size_t count = bodies.spheres();
    if (count < 2)
        return;
    // The two largest may meet; most pairs are of beads, so cells fit the pair of the largest kinds present.
    const double widest = *std::max_element(bodies.radius.begin(), bodies.radius.end());
    const std::vector<double> x = column(bodies.position, count, 0), y = column(bodies.position, count, 1);
    const CellList cells(x, y, box, 2.0 * widest + skin);
    std::vector<PairList> found((count + spheres_a_task - 1) / spheres_a_task);
    team.run(found.size(), [&](std::size_t c) {
        pairs_of(bodies, cells, box, skin, c * spheres_a_task, std::min(count, (c + 1) * spheres_a_task),
                 found[c]);
    });
    gather(found, team, list);
}

} // namespace rodwake::granular
