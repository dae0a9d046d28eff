// The estimator `density`: rho_0(r) = rho(r + U(r)) by the Fourier content at G_k, in a window around r, of
// the time-averaged density in the rod's frame.
//
// The window is a Gaussian of standard deviation 0.75 lattice spacings. It must be that wide: the mean
// density, which has no phase, leaks into the content at G_k by exp(-(G s)^2/2), here 1e-6; within a bin
// alone it would look like a lattice that belongs to the grid. Its price is that U is blurred over the
// window.

#include "phase_blocks.hpp"
#include "cell_window.hpp"
#include "displacement_impl.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

namespace rodwake::measure {

namespace {

constexpr double window_width = 0.75,
                 cut = 4.0; // standard deviation in lattice spacings; its reach in itself
constexpr std::size_t channels = PhaseAccumulator::channels;

using BinSums = std::vector<double>;

/// Adds w times the sums of a bin `apart` away along one axis.
void add_bin(double* to, const double* from, double w, double apart, std::size_t place) {
    for (std::size_t c = 0; c < channels; ++c)
        to[c] += w * from[c];
    to[place] += w * apart * from[PhaseAccumulator::beads]; // places count from the bin's own middle
}

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
    const std::size_t place = along_x ? PhaseAccumulator::place_x : PhaseAccumulator::place_y;
    for (long j = 0; j < n * m; ++j)
        for (long k = -reach; k <= reach; ++k) {
            const long from = along_x ? j / n * n + (j % n + k + n) % n : (j / n + k + m) % m * n + j % n;
            const double apart = static_cast<double>(k) * spacing;
            add_bin(&result[static_cast<std::size_t>(j) * channels],
                    &sums[static_cast<std::size_t>(from) * channels],
                    weight[static_cast<std::size_t>(k + reach)] / total, apart, place);
        }
    return result;
}

std::complex<double> far_sum(const BinSums& sums, std::size_t k, const RodGrid& grid, double far_from) {
    std::complex<double> total = 0.0;
    for (std::size_t j = 0; j < grid.bins(); ++j)
        if (std::hypot(grid.x_of(j), grid.y_of(j)) > far_from)
            total += std::complex<double>(sums[j * channels + 2 * k], sums[j * channels + 2 * k + 1]);
    return total;
}

void take_off(BinSums& sums, std::size_t k, const std::complex<double>& phase) {
    for (std::size_t at = 2 * k; at < sums.size(); at += channels) {
        const auto z = times({sums[at], sums[at + 1]}, phase);
        sums[at] = z.real();
        sums[at + 1] = z.imag();
    }
}

/// The block's sums (PhaseAccumulator's channels) in the window around each bin's middle, the far field's
/// phases taken off.
std::vector<double> windowed_density(const BlockSums& block, const RodGrid& grid, double lattice_spacing,
                                     double far_from) {
    const double width = window_width * lattice_spacing;
    BinSums sums = blurred(blurred(block.sums, grid, width, true), grid, width, false);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto far = far_sum(sums, k, grid, far_from);
        if (far != 0.0)
            take_off(sums, k, std::conj(far) / std::abs(far));
    }
    return sums;
}

PhaseBlock lattice_of(const BraggPeaks& peaks, const BlockSums& block, Follows follows) {
    PhaseBlock made;
    made.m = peaks.m;
    made.n = peaks.n;
    made.heading = block.heading();
    made.frames = block.frames;
    made.follows = follows;
    return made;
}

} // namespace

std::vector<PhaseBlock> phase_blocks(std::span<const DisplacementAccumulator> runs,
                                     std::vector<std::vector<double>>& smoothed) {
    std::vector<PhaseBlock> blocks;
    for (const DisplacementAccumulator& run : runs) {
        const auto& accumulator = std::get<PhaseAccumulator>(DisplacementSums::of(run).sums);
        const RodGrid grid = grid_of(run);
        const BlockSums* before = nullptr;
        for (const BlockSums& block : accumulator.blocks()) {
            PhaseBlock made = lattice_of(*accumulator.peaks(), block, follows_of(before, block));
            before = &block;
            if (run.options().method == DisplacementMethod::density) {
                made.g = seen_along(accumulator.peaks()->G, block.first_heading);
                smoothed.push_back(windowed_density(block, grid, lattice_spacing(run.layout()),
                                                    DisplacementSums::of(run).far_from));
                made.sums = smoothed.back(); // a moved vector keeps its values in place
            } else {
                made.g = seen_along(accumulator.peaks()->G, made.heading);
                made.sums = block.sums;
            }
            blocks.push_back(made);
        }
    }
    return blocks;
}

} // namespace rodwake::measure
