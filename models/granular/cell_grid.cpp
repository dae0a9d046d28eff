#include "cell_grid.hpp"

#include "rodwake/core/cell_list.hpp"
#include "rodwake/core/periodic.hpp"

#include <algorithm>

namespace rodwake::granular {

namespace {

/// Columns of the packed rows.
std::vector<double> column(const Rows& position, std::size_t count, std::size_t k) {
    std::vector<double> out(count);
    for (std::size_t i = 0; i < count; ++i)
        out[i] = position[4 * i + k];
    return out;
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
    const std::vector<double> x = column(position, count, 0), y = column(position, count, 1);
    const CellList cells(x, y, box, 2.0 * widest + skin);
    std::vector<std::uint32_t> partners;
    for (std::size_t i = 0; i < count; ++i) {
        partners.clear();
        cells.around(cells.column(x[i]), cells.column(y[i]), [&](std::size_t k) {
            const std::uint32_t j = cells.member()[k];
            if (j <= i || (i >= beads && rod_of[i - beads] == rod_of[j - beads]))
                return;
            const double dx = nearest_image_rounded(x[i] - cells.x()[k], box),
                         dy = nearest_image_rounded(y[i] - cells.y()[k], box);
            const double reach = radius[i] + radius[j] + skin;
            if (dx * dx + dy * dy < reach * reach)
                partners.push_back(j);
        });
        std::sort(partners.begin(), partners.end());
        for (const std::uint32_t j : partners) {
            list.pairs.push_back({static_cast<std::uint32_t>(i), j});
            list.reach.push_back(radius[i] + radius[j]);
        }
    }
}

} // namespace rodwake::granular
