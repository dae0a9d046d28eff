#include "cells.hpp"

namespace rodwake::measure {

namespace {

/// Cells a side: fewer than 3 would be their own neighbours, and more than beads would only cost time.
std::size_t cells_a_side(std::size_t beads, double box, double cutoff) {
    const double most = std::ceil(std::sqrt(static_cast<double>(beads))) + 1.0;
    const double fit = std::min(std::floor(box / cutoff), most);
    return fit >= 3.0 ? static_cast<std::size_t>(fit) : 1;
}

} // namespace

Cells sort_into_cells(const std::vector<double>& x, const std::vector<double>& y, double box, double cutoff) {
    const std::size_t side = cells_a_side(x.size(), box, cutoff), count = x.size();
    const double per_cell = static_cast<double>(side) / box;
    const auto place = [&](double at) { return std::min(side - 1, static_cast<std::size_t>(at * per_cell)); };
    Cells cells{side, std::vector<std::uint32_t>(side * side + 1, 0), std::vector<std::uint32_t>(count),
                std::vector<double>(count), std::vector<double>(count)};
    for (std::size_t i = 0; i < count; ++i)
        ++cells.start[place(y[i]) * side + place(x[i]) + 1];
    for (std::size_t c = 0; c < side * side; ++c)
        cells.start[c + 1] += cells.start[c];
    std::vector<std::uint32_t> next(cells.start.begin(), cells.start.end() - 1);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t at = next[place(y[i]) * side + place(x[i])]++;
        cells.bead[at] = static_cast<std::uint32_t>(i);
        cells.x[at] = x[i];
        cells.y[at] = y[i];
    }
    return cells;
}

} // namespace rodwake::measure
