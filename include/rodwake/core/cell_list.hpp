#pragma once
// Places in the periodic plane sorted into square cells, so that who is near whom is found without looking at
// all pairs.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rodwake {

/// CellList at least `reach` wide: whoever is nearer than the reach is in the same cell or one of the eight
/// around. Where fewer than three fit across, one cell holds all. Members of a cell are in the order of their
/// numbers, so everything that is found comes in an order that depends on the places alone.
class CellList {
public:
    /// Places anywhere, box > 0, reach > 0; as many x as y.
    CellList(std::span<const double> x, std::span<const double> y, double box, double reach);

    std::size_t across() const { return across_; }
    double width() const { return box_ / static_cast<double>(across_); }
    /// Of a coordinate; rows are counted as columns are.
    std::size_t column(double coordinate) const;

    /// In the order of the cells: the number of each place, and the place as it was given, so that a loop
    /// over a cell reads memory in order.
    const std::vector<std::uint32_t>& member() const { return member_; }
    const std::vector<double>& x() const { return x_; }
    const std::vector<double>& y() const { return y_; }

    /// Calls use(k) for each index k of member() in a cell; columns and rows are counted round the box, from
    /// -across on.
    template<class Use>
    void in_cell(std::ptrdiff_t column, std::ptrdiff_t row, Use&& use) const {
        const auto n = static_cast<std::ptrdiff_t>(across_);
        each(static_cast<std::size_t>((column + n) % n + n * ((row + n) % n)), use);
    }

    /// The cell of a column and row and those around it, each once.
    template<class Use>
    void around(std::size_t column, std::size_t row, Use&& use) const {
        if (across_ == 1)
            return each(0, use);
        const auto before = [&](std::size_t at) { return at == 0 ? across_ - 1 : at - 1; };
        const auto after = [&](std::size_t at) { return at + 1 == across_ ? 0 : at + 1; };
        for (const std::size_t j : {before(row), row, after(row)})
            for (const std::size_t i : {before(column), column, after(column)})
                each(i + across_ * j, use);
    }

    /// Calls see(p, q) once for each pair of indices of member() in the same or neighbouring cells.
    template<class See>
    void pairs(See&& see) const {
        const std::size_t n = across_;
        for (std::size_t row = 0; row < n; ++row)
            for (std::size_t column = 0; column < n; ++column) {
                const std::size_t cell = row * n + column, right = (column + 1) % n,
                                  left = (column + n - 1) % n, below = (row + 1) % n * n;
                const auto look = [&](std::size_t p, std::size_t from, std::size_t to) {
                    for (std::size_t q = from; q < to; ++q)
                        see(p, q);
                };
                for (std::size_t p = start_[cell]; p < start_[cell + 1]; ++p) {
                    look(p, p + 1, start_[cell + 1]);
                    if (n == 1)
                        continue;
                    // half of the eight cells around, so that each two cells are seen once
                    for (const std::size_t other :
                         {row * n + right, below + left, below + column, below + right})
                        look(p, start_[other], start_[other + 1]);
                }
            }
    }

private:
    template<class Use>
    void each(std::size_t cell, Use&& use) const {
        for (std::size_t k = start_[cell]; k < start_[cell + 1]; ++k)
            use(k);
    }

    double box_;
    std::size_t across_ = 1;
    std::vector<std::uint32_t> start_, member_; ///< members of cell c: member[start[c]] .. member[start[c+1]]
    std::vector<double> x_, y_;
};

} // namespace rodwake
