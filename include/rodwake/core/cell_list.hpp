#pragma once
// Places in the periodic plane sorted into equal cells, so that who is near whom is found without looking at
// all pairs.

#include "rodwake/core/periodic.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rodwake {

/// CellList at least `reach` wide: whoever is nearer than the reach is in the same cell or one of the eight
/// around. Along a side that fewer than three fit into there is one. Members of a cell are in the order of
/// their numbers, so everything that is found comes in an order that depends on the places alone.
class CellList {
public:
    /// Places anywhere, sides > 0, reach > 0; as many x as y.
    CellList(std::span<const double> x, std::span<const double> y, const PeriodicBox& box, double reach);

    std::size_t columns() const { return columns_; }
    std::size_t rows() const { return rows_; }
    double width() const { return box_.x / static_cast<double>(columns_); }
    double height() const { return box_.y / static_cast<double>(rows_); }
    std::size_t column(double x) const;
    std::size_t row(double y) const;

    /// In the order of the cells: the number of each place, and the place as it was given, so that a loop
    /// over a cell reads memory in order.
    const std::vector<std::uint32_t>& member() const { return member_; }
    const std::vector<double>& x() const { return x_; }
    const std::vector<double>& y() const { return y_; }

    /// Calls use(k) for each index k of member() in a cell; columns and rows are counted round the box, from
    /// -columns() and -rows() on.
    template<class Use>
    void in_cell(std::ptrdiff_t column, std::ptrdiff_t row, Use&& use) const {
        const auto n = static_cast<std::ptrdiff_t>(columns_), m = static_cast<std::ptrdiff_t>(rows_);
        const auto cell = static_cast<std::size_t>((column + n) % n + n * ((row + m) % m));
        for (std::size_t k = start_[cell]; k < start_[cell + 1]; ++k)
            use(k);
    }

    /// The cell of a column and row and those around it, each once: its first index and the one after its
    /// last.
    template<class Use>
    void cells_around(std::size_t column, std::size_t row, Use&& use) const {
        const Near i = near(column, columns_), j = near(row, rows_);
        for (std::size_t k = 0; k < j.count; ++k)
            for (std::size_t l = 0; l < i.count; ++l) {
                const std::size_t cell = i.at[l] + columns_ * j.at[k];
                use(std::size_t{start_[cell]}, std::size_t{start_[cell + 1]});
            }
    }

    /// The indices in those cells.
    template<class Use>
    void around(std::size_t column, std::size_t row, Use&& use) const {
        cells_around(column, row, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                use(k);
        });
    }

    /// Calls see(p, q) once for each pair of indices of member() in the same or neighbouring cells.
    template<class See>
    void pairs(See&& see) const {
        const std::size_t n = columns_, m = rows_;
        for (std::size_t row = 0; row < m; ++row)
            for (std::size_t column = 0; column < n; ++column) {
                const std::size_t cell = row * n + column, right = (column + 1) % n,
                                  left = (column + n - 1) % n, below = (row + 1) % m * n;
                const auto look = [&](std::size_t p, std::size_t from, std::size_t to) {
                    for (std::size_t q = from; q < to; ++q)
                        see(p, q);
                };
                for (std::size_t p = start_[cell]; p < start_[cell + 1]; ++p) {
                    look(p, p + 1, start_[cell + 1]);
                    // half of the eight cells around, so that each two cells are seen once
                    const std::size_t half[] = {row * n + right, below + left, below + column, below + right};
                    for (std::size_t k = 0; k < 4; ++k)
                        if ((k == 2 || n > 1) && (k == 0 || m > 1))
                            look(p, start_[half[k]], start_[half[k] + 1]);
                }
            }
    }

private:
    struct Near {
        std::size_t at[3], count;
    };
    /// Of n round the box: the one before, it itself and the one after; one alone has no others.
    static Near near(std::size_t at, std::size_t n) {
        return n == 1 ? Near{{0}, 1} : Near{{at == 0 ? n - 1 : at - 1, at, at + 1 == n ? 0 : at + 1}, 3};
    }

    PeriodicBox box_;
    std::size_t columns_ = 1, rows_ = 1;
    std::vector<std::uint32_t> start_, member_; ///< members of cell c: member[start[c]] .. member[start[c+1]]
    std::vector<double> x_, y_;
};

} // namespace rodwake
