#include "rodwake/core/cell_list.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake {

namespace {

/// Fewer than 3 would be their own neighbours, and many more than places would only cost memory.
std::size_t cells_along(double side, double other, std::size_t count, double reach) {
    const double most = 2.0 * std::sqrt(static_cast<double>(count) * (side / other)) + 3.0;
    const double fit = std::min(std::floor(side / reach), most);
    return fit >= 3.0 ? static_cast<std::size_t>(fit) : 1;
}

std::size_t cell_of(double coordinate, double side, double width, std::size_t cells) {
    return std::min(cells - 1, static_cast<std::size_t>(into_box(coordinate, side) / width));
}

} // namespace

CellList::CellList(std::span<const double> x, std::span<const double> y, const PeriodicBox& box, double reach)
    : box_(box), columns_(cells_along(box.x, box.y, x.size(), reach)),
      rows_(cells_along(box.y, box.x, x.size(), reach)), member_(x.size()), x_(x.size()), y_(x.size()) {
    // A long box that is mostly empty needs no more cells than places either.
    const std::size_t most = 16 * x.size() + 1024;
    if (columns_ * rows_ > most)
        (columns_ > rows_ ? columns_ : rows_) = most / std::min(columns_, rows_);
    start_.assign(columns_ * rows_ + 1, 0);
    std::vector<std::uint32_t> cell(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        cell[i] = static_cast<std::uint32_t>(column(x[i]) + columns_ * row(y[i]));
        ++start_[cell[i] + 1];
    }
    for (std::size_t c = 1; c < start_.size(); ++c)
        start_[c] += start_[c - 1];
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const std::uint32_t at = next[cell[i]]++;
        member_[at] = static_cast<std::uint32_t>(i);
        x_[at] = x[i];
        y_[at] = y[i];
    }
}

std::size_t CellList::column(double x) const { return cell_of(x, box_.x, width(), columns_); }
std::size_t CellList::row(double y) const { return cell_of(y, box_.y, height(), rows_); }

} // namespace rodwake
