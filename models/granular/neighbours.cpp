#include "neighbours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::granular {

namespace {

/// Beads sorted into square cells at least `range` wide. Fewer than three cells across: one, that holds all.
class Cells {
public:
    Cells(const Places& places, double box, double range) : box_(box) {
        const double across =
            std::min(std::floor(box / range), 2.0 * std::sqrt(static_cast<double>(places.size())) + 3.0);
        across_ = across < 3.0 ? 1 : static_cast<int>(across);
        std::vector<std::uint32_t> cell(places.size());
        first_.assign(static_cast<std::size_t>(across_) * static_cast<std::size_t>(across_) + 1, 0);
        for (std::size_t k = 0; k < places.size(); ++k) {
            cell[k] = static_cast<std::uint32_t>(column(places.x[k]) + across_ * column(places.y[k]));
            ++first_[cell[k] + 1];
        }
        for (std::size_t c = 1; c < first_.size(); ++c)
            first_[c] += first_[c - 1];
        beads_.resize(places.size());
        auto next = first_;
        for (std::size_t k = 0; k < places.size(); ++k)
            beads_[next[cell[k]]++] = static_cast<std::uint32_t>(k);
    }

    int across() const { return across_; }
    double width() const { return box_ / across_; }
    int column(double coordinate) const {
        return std::min(static_cast<int>(wrap(coordinate, box_) / width()), across_ - 1);
    }
    /// Calls `use` for each bead of the cell, columns and rows counted round the box.
    template<class Use>
    void each(int column, int row, Use use) const {
        const int cell = (column + across_) % across_ + across_ * ((row + across_) % across_);
        for (auto k = first_[static_cast<std::size_t>(cell)]; k < first_[static_cast<std::size_t>(cell) + 1];
             ++k)
            use(beads_[k]);
    }

private:
    double box_;
    int across_ = 1;
    std::vector<std::uint32_t> first_, beads_;
};

double square_in_plan(double dx, double dy, double box) {
    dx = nearest_image(dx, box);
    dy = nearest_image(dy, box);
    return dx * dx + dy * dy;
}

void bead_pairs(const Places& p, const Cells& cells, double box, double range, std::vector<Near>& pairs) {
    // Half of the eight cells around, so that each pair of cells is seen once.
    static constexpr std::array<std::array<int, 2>, 5> ahead{{{0, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}};
    const std::size_t directions = cells.across() == 1 ? 1 : ahead.size();
    for (int row = 0; row < cells.across(); ++row)
        for (int column = 0; column < cells.across(); ++column)
            cells.each(column, row, [&](std::uint32_t i) {
                for (std::size_t d = 0; d < directions; ++d)
                    cells.each(column + ahead[d][0], row + ahead[d][1], [&](std::uint32_t j) {
                        if ((d > 0 || i < j) &&
                            square_in_plan(p.x[i] - p.x[j], p.y[i] - p.y[j], box) < range * range)
                            pairs.push_back({i, j});
                    });
            });
}

void rod_pairs(const Places& p, const Cells& cells, const Room& room, double skin, std::vector<Near>& pairs) {
    for (std::size_t k = 0; k < room.rods.size(); ++k) {
        const Disc& disc = room.rods[k];
        const double range = disc.radius + room.radius + skin;
        const int wide = std::min(static_cast<int>(std::ceil(range / cells.width())), cells.across());
        const int span = std::min(2 * wide + 1, cells.across());
        const int column = cells.column(disc.x) - span / 2, row = cells.column(disc.y) - span / 2;
        for (int i = 0; i < span; ++i)
            for (int j = 0; j < span; ++j)
                cells.each(column + i, row + j, [&](std::uint32_t bead) {
                    if (square_in_plan(p.x[bead] - disc.x, p.y[bead] - disc.y, room.box) < range * range)
                        pairs.push_back({bead, static_cast<std::uint32_t>(k)});
                });
    }
}

} // namespace

Neighbours neighbours(const Places& places, const Room& room, double skin) {
    const double range = 2.0 * room.radius + skin;
    const Cells cells(places, room.box, range);
    Neighbours found;
    bead_pairs(places, cells, room.box, range, found.beads);
    rod_pairs(places, cells, room, skin, found.rods);
    return found;
}

} // namespace rodwake::granular
