#include "phase_cell.hpp"

#include "displacement_impl.hpp"
#include "plane_waves.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

namespace rodwake::measure {

namespace {

constexpr int newton_steps = 8;

} // namespace

PhaseCell::PhaseCell(const std::vector<PhaseBlock>& blocks, const std::vector<CellPart>& parts)
    : blocks_(blocks), sums_(blocks.size()) {
    for (std::size_t b = 0; b < blocks.size(); ++b)
        for (const CellPart& part : parts) {
            const double* from = &blocks[b].sums[part.bin * PhaseAccumulator::channels];
            if (from[PhaseAccumulator::beads] == 0.0)
                continue;
            const bool moved = part.difference != Vector2{};
            const PhaseFactors back = moved ? plane_waves(blocks[b].g, -part.difference.x, -part.difference.y)
                                            : PhaseFactors{1.0, 1.0, 1.0};
            for (std::size_t k = 0; k < 3; ++k) {
                const auto z = times({from[2 * k], from[2 * k + 1]}, back[k]);
                sums_[b][2 * k] += part.weight * z.real();
                sums_[b][2 * k + 1] += part.weight * z.imag();
            }
            for (const std::size_t c :
                 {PhaseAccumulator::beads, PhaseAccumulator::place_x, PhaseAccumulator::place_y})
                sums_[b][c] += part.weight * from[c];
        }
}

double PhaseCell::total(std::size_t channel) const {
    double sum = 0.0;
    for (const auto& block : sums_)
        sum += block[channel];
    return sum;
}

void PhaseCell::solve(Vector2& u) {
    for (int step = 0; step < newton_steps; ++step) {
        look(u);
        Vector2 sum;
        for (const Vector2& slope : slopes_) {
            sum.x += slope.x;
            sum.y += slope.y;
        }
        const auto move = inverse(sum);
        if (!move)
            return;
        const double size = std::hypot(move->x, move->y) * longest_;
        const double part = size > 0.5 ? 0.5 / size : 1.0; // at most half a radian
        u.x += part * move->x;
        u.y += part * move->y;
        if (size < 1e-8) // the next step would be the square of it
            return;
    }
}

std::vector<Vector2> PhaseCell::pulls(const Vector2& u) {
    look(u);
    std::vector<Vector2> result(slopes_.size());
    for (std::size_t b = 0; b < slopes_.size(); ++b)
        result[b] = inverse(slopes_[b]).value_or(Vector2{});
    return result;
}

std::vector<bool> PhaseCell::present() const {
    std::vector<bool> result(sums_.size());
    for (std::size_t b = 0; b < sums_.size(); ++b)
        result[b] = sums_[b][PhaseAccumulator::beads] > 0.0;
    return result;
}

double PhaseCell::coherence() const {
    return std::clamp(in_phase_ / (3.0 * total(PhaseAccumulator::beads)), 0.0, 1.0);
}

/// Slope of each block's likelihood and curvature of all.
void PhaseCell::look(const Vector2& u) {
    xx_ = xy_ = yy_ = in_phase_ = longest_ = 0.0;
    slopes_.assign(sums_.size(), {});
    for (std::size_t b = 0; b < sums_.size(); ++b) {
        if (sums_[b][PhaseAccumulator::beads] == 0.0)
            continue;
        const PhaseFactors back = plane_waves(blocks_[b].g, -u.x, -u.y);
        for (std::size_t k = 0; k < 3; ++k) {
            const Vector2& g = blocks_[b].g[k];
            const auto z = times({sums_[b][2 * k], sums_[b][2 * k + 1]}, back[k]);
            slopes_[b].x += g.x * z.imag();
            slopes_[b].y += g.y * z.imag();
            xx_ += g.x * g.x * z.real();
            xy_ += g.x * g.y * z.real();
            yy_ += g.y * g.y * z.real();
            in_phase_ += z.real();
            longest_ = std::max(longest_, std::abs(g.x) + std::abs(g.y));
        }
    }
}

std::optional<Vector2> PhaseCell::inverse(const Vector2& v) const {
    const double determinant = xx_ * yy_ - xy_ * xy_;
    if (!(xx_ > 0.0 && determinant > 1e-6 * xx_ * yy_))
        return std::nullopt;
    return Vector2{(yy_ * v.x - xy_ * v.y) / determinant, (xx_ * v.y - xy_ * v.x) / determinant};
}

namespace {

constexpr double lattice_radius =
    0.71; // J_2 has its first zero at 5.136 = G R, G = 4 pi/sqrt(3) over the spacing
constexpr double least_radius = 0.75;  // spacings of the grid
constexpr double largest_offset = 0.4; // of the data's centre from the middle, in radii
constexpr double largest_radius = 4.0; // spacings; finer grids are not for this

} // namespace

double lattice_spacing(const Layout& layout) {
    return std::sqrt(seen_area(layout)) *
           std::sqrt(2.0 / (std::sqrt(3.0) * static_cast<double>(layout.beads)));
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
    for (const NearSample& sample : scattered_.around(bin, radius_)) {
        const double weight = 1.0 - (sample.x * sample.x + sample.y * sample.y) / (radius_ * radius_);
        if (weight <= 0.0)
            continue;
        mean.parts.push_back(
            {sample.sample, weight, fit ? fit->linear_difference(sample.x, sample.y) : Vector2{}});
        const double part = weight * bins_.count[sample.sample];
        beads += part;
        x += part * sample.x;
        y += part * sample.y;
    }
    if (!(beads > 0.0) || (fit && std::hypot(x, y) > largest_offset * radius_ * beads))
        return {};
    mean.guess = fit ? fit->at(0.0, 0.0) : bins_.value[mean.parts.front().bin];
    mean.place = {x / beads * grid_.width, y / beads * grid_.height};
    mean.count =
        beads / (0.5 * M_PI * radius_ * radius_); // integral of the window, bins without data included
    return mean;
}

// The estimator `density`: rho_0(r) = rho(r + U(r)) by the Fourier content at G_k, in a window around r, of
// the time-averaged density in the rod's frame.
//
// The window is a Gaussian of standard deviation 0.75 lattice spacings. It must be that wide: the mean
// density, which has no phase, leaks into the content at G_k by exp(-(G s)^2/2), here 1e-6; within a bin
// alone it would look like a lattice that belongs to the grid. Its price is that U is blurred over the
// window.

namespace {

constexpr std::size_t phase_channels = PhaseAccumulator::channels;

constexpr double window_width = 0.75,
                 cut = 4.0; // standard deviation in lattice spacings; its reach in itself

using BinSums = std::vector<double>;

/// Weighted means along x or y of the periodic grid.
BinSums blurred(const BinSums& sums, const RodGrid& grid, double width, bool along_x) {
    BinSums result(sums.size(), 0.0);
    const double spacing = along_x ? grid.width : grid.height;
    const long n = static_cast<long>(grid.columns), m = static_cast<long>(grid.rows),
               reach = std::min(static_cast<long>(cut * width / spacing), (along_x ? n : m) / 2 - 1);
    std::vector<double> weight;
    for (long k = -reach; k <= reach; ++k)
        weight.push_back(std::exp(-0.5 * std::pow(static_cast<double>(k) * spacing / width, 2)));
    const double total = std::accumulate(weight.begin(), weight.end(), 0.0);
    const std::size_t index = along_x ? PhaseAccumulator::place_x : PhaseAccumulator::place_y;
    for (long j = 0; j < n * m; ++j)
        for (long k = -reach; k <= reach; ++k) {
            const long from = along_x ? j / n * n + (j % n + k + n) % n : (j / n + k + m) % m * n + j % n;
            const double apart = static_cast<double>(k) * spacing;
            const double w = weight[static_cast<std::size_t>(k + reach)] / total;
            double* to = &result[static_cast<std::size_t>(j) * phase_channels];
            const double* bin = &sums[static_cast<std::size_t>(from) * phase_channels];
            for (std::size_t c = 0; c < phase_channels; ++c)
                to[c] += w * bin[c];
            to[index] += w * apart * bin[PhaseAccumulator::beads]; // places count from the bin's own middle
        }
    return result;
}

/// The block's sums (PhaseAccumulator's phase_channels) in the window around each bin's middle, the far
/// field's phases taken off.
std::vector<double> windowed_density(const BlockSums& block, const RodGrid& grid, double lattice_spacing,
                                     double far_from) {
    const double width = window_width * lattice_spacing;
    BinSums sums = blurred(blurred(block.sums, grid, width, true), grid, width, false);
    for (std::size_t k = 0; k < 3; ++k) {
        std::complex<double> far = 0.0;
        for (std::size_t j = 0; j < grid.bins(); ++j)
            if (std::hypot(grid.x_of(j), grid.y_of(j)) > far_from)
                far += std::complex<double>(sums[j * phase_channels + 2 * k],
                                            sums[j * phase_channels + 2 * k + 1]);
        if (far == 0.0)
            continue;
        const std::complex<double> phase = std::conj(far) / std::abs(far);
        for (std::size_t at = 2 * k; at < sums.size(); at += phase_channels) {
            const auto z = times({sums[at], sums[at + 1]}, phase);
            sums[at] = z.real();
            sums[at + 1] = z.imag();
        }
    }
    return sums;
}

} // namespace

std::vector<PhaseBlock> phase_blocks(std::span<const DisplacementAccumulator> runs,
                                     std::vector<std::vector<double>>& smoothed) {
    std::vector<PhaseBlock> blocks;
    for (const DisplacementAccumulator& run : runs) {
        const auto& accumulator = std::get<PhaseAccumulator>(DisplacementSums::of(run).sums);
        const RodGrid grid = grid_of(run);
        const BlockSums* before = nullptr;
        for (std::size_t b = 0; b < accumulator.blocks().size(); ++b) {
            const BlockSums& block = accumulator.blocks()[b];
            const BraggPeaks& peaks = accumulator.peaks(b);
            PhaseBlock made;
            made.m = peaks.m;
            made.n = peaks.n;
            made.heading = block.heading();
            made.frames = block.frames;
            made.follows = follows_of(before, block);
            before = &block;
            if (run.layout().window)
                made.m = made.n = {}; // no whole numbers of waves
            if (run.options().method == DisplacementMethod::density) {
                made.g = seen_along(peaks.G, block.first_heading);
                smoothed.push_back(windowed_density(block, grid, lattice_spacing(run.layout()),
                                                    DisplacementSums::of(run).far_from));
                made.sums = smoothed.back(); // a moved vector keeps its values in place
            } else {
                made.g = seen_along(peaks.G, made.heading);
                made.sums = block.sums;
                if (run.layout().window) {
                    smoothed.push_back(block.sums); // what is taken off them is not the accumulator's
                    made.sums = smoothed.back();
                }
            }
            blocks.push_back(made);
        }
    }
    return blocks;
}

} // namespace rodwake::measure
