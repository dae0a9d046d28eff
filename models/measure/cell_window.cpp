#include "cell_window.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr double lattice_radius =
    0.71; // J_2 has its first zero at 5.136 = G R, G = 4 pi/sqrt(3) over the spacing
constexpr double least_radius = 0.75;  // spacings of the grid
constexpr double largest_offset = 0.4; // of the data's centre from the middle, in radii
constexpr double largest_radius = 4.0; // spacings; finer grids are not for this

} // namespace

double lattice_spacing(const Layout& layout) {
    return layout.box.mean_side() * std::sqrt(2.0 / (std::sqrt(3.0) * static_cast<double>(layout.beads)));
}

CellWindow::CellWindow(const BinSamples& bins, const BinSamples* smooth, const RodGrid& grid, double spacing)
    : bins_(bins), smooth_(smooth), grid_(grid), scattered_(bins, bins.place, grid),
      radius_(std::clamp(lattice_radius * spacing / grid.width, least_radius, largest_radius)) {
    if (smooth)
        to_fit_.emplace(*smooth, smooth->place, grid);
}

CellMean CellWindow::around(std::size_t bin) const {
    CellMean mean;
    std::optional<LocalFit> fit;
    if (to_fit_)
        fit.emplace(to_fit_->around(bin, LocalFit::reach), *smooth_);
    double beads = 0.0, x = 0.0, y = 0.0;
    for (const Near& one : scattered_.around(bin, radius_)) {
        const double weight = 1.0 - (one.x * one.x + one.y * one.y) / (radius_ * radius_);
        if (weight <= 0.0)
            continue;
        mean.parts.push_back({one.sample, weight, fit ? fit->linear_difference(one.x, one.y) : Vector2{}});
        const double part = weight * bins_.count[one.sample];
        beads += part;
        x += part * one.x;
        y += part * one.y;
    }
    if (!(beads > 0.0) || (fit && std::hypot(x, y) > largest_offset * radius_ * beads))
        return {};
    mean.guess = fit ? fit->at(0.0, 0.0) : bins_.value[mean.parts.front().bin];
    mean.place = {x / beads * grid_.width, y / beads * grid_.height};
    mean.count =
        beads / (0.5 * M_PI * radius_ * radius_); // integral of the window, bins without data included
    return mean;
}

} // namespace rodwake::measure
