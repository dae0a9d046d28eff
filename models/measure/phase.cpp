#include "blocks.hpp"
#include "displacement_impl.hpp"
#include "estimators.hpp"
#include "far_lattice.hpp"
#include "phase_cell.hpp"
#include "regrid.hpp"
#include "rodwake/core/error.hpp"
#include "unwrap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace rodwake::measure {

namespace {

constexpr double same_heading = 0.1;  // rad
constexpr std::size_t least_far = 12; // beads for a lattice
constexpr double full_count = 10.0;   // beads at which a bin's coherence begins to be trusted
constexpr std::size_t channels = PhaseAccumulator::channels;

/// In a window wave vectors are no whole numbers of waves.
bool alike(const PhaseBlock& a, const PhaseBlock& b) {
    constexpr double near = 0.15; // of the wave vector: more than headings make
    const auto differ = [&](std::size_t k) {
        return std::hypot(a.g[k].x - b.g[k].x, a.g[k].y - b.g[k].y) > near * std::hypot(a.g[k].x, a.g[k].y);
    };
    return a.m == b.m && a.n == b.n &&
           std::abs(std::remainder(a.heading - b.heading, 2.0 * M_PI)) <= same_heading && !differ(0) &&
           !differ(2);
}

/// Bins without beads of those blocks are filled in.
std::vector<Vector2> first_guess(const std::vector<PhaseBlock>& blocks, const RodGrid& grid,
                                 double far_from) {
    // The centre is the block to which most frames are alike.
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t a = 0; a < blocks.size(); ++a) {
        double frames = 0.0;
        for (const PhaseBlock& b : blocks)
            frames += alike(blocks[a], b) ? b.frames : 0.0;
        if (frames > most) {
            most = frames;
            best = a;
        }
    }
    const PhaseBlock& centre = blocks[best];
    std::vector<double> pooled(centre.sums.size(), 0.0);
    for (const PhaseBlock& block : blocks)
        if (alike(centre, block))
            std::ranges::transform(pooled, block.sums, pooled.begin(), std::plus{});
    std::vector<Vector2> u(grid.bins());
    std::vector<double> good(grid.bins()); // coherence of the bins
    BraggPeaks axes;
    axes.G = centre.g;
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        // phase_1 = phase_0 + phase_2 holds up to noise and a whole turn, which is taken out.
        const double* sums = &pooled[j * channels];
        std::array<double, 3> phase{};
        double size = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            phase[k] = std::atan2(sums[2 * k + 1], sums[2 * k]);
            size += std::hypot(sums[2 * k], sums[2 * k + 1]) / 3.0;
        }
        const double sum = phase[0] + phase[2], count = sums[PhaseAccumulator::beads];
        phase[1] = sum + std::remainder(phase[1] - sum, 2.0 * M_PI);
        u[j] = displacement_of(axes, phase);
        good[j] = count > 0.0 ? size / (count + full_count) : 0.0;
    }
    const auto done = unwrap(u, good, grid, LatticeVectors(centre.g), far_from);
    for (double Vector2::*part : {&Vector2::x, &Vector2::y}) {
        std::vector<double> values(u.size());
        std::ranges::transform(u, values.begin(), [&](const Vector2& v) { return v.*part; });
        fill_in(values, done, grid.columns);
        for (std::size_t j = 0; j < u.size(); ++j)
            u[j].*part = values[j];
    }
    return u;
}

constexpr double least_contrast = 20.0;

std::vector<Follows> follows_of(const std::vector<PhaseBlock>& blocks) {
    std::vector<Follows> follows;
    follows.reserve(blocks.size());
    for (const PhaseBlock& block : blocks)
        follows.push_back(block.follows);
    return follows;
}

/// Places are those of the beads.
BinSamples of_bins(const std::vector<PhaseBlock>& blocks, std::vector<Vector2> guess, const RodGrid& grid) {
    BinSamples samples(grid.bins());
    samples.value = std::move(guess);
    BlockScatter scatter(grid.bins());
    const auto follows = follows_of(blocks);
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        PhaseCell cell(blocks, {{j, 1.0, {}}});
        const double beads = samples.count[j] = cell.total(PhaseAccumulator::beads);
        if (!(beads > 0.0))
            continue;
        cell.solve(samples.value[j]);
        scatter.add(j, cell.pulls(samples.value[j]), cell.present(), follows);
        samples.coherence[j] = cell.coherence();
        samples.place[j] = {grid.x_of(j) + cell.total(PhaseAccumulator::place_x) / beads,
                            grid.y_of(j) + cell.total(PhaseAccumulator::place_y) / beads};
    }
    scatter.finish(samples);
    return samples;
}

/// Places are the centres of the cells' data.
BinSamples of_cells(const std::vector<PhaseBlock>& blocks, const CellWindow& window, const RodGrid& grid) {
    BinSamples samples(grid.bins());
    BlockScatter scatter(grid.bins());
    const auto follows = follows_of(blocks);
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        const CellMean mean = window.around(j);
        samples.place[j] = {grid.x_of(j) + mean.place.x, grid.y_of(j) + mean.place.y};
        samples.count[j] = mean.count;
        samples.value[j] = mean.guess;
        if (mean.parts.empty())
            continue;
        PhaseCell cell(blocks, mean.parts);
        cell.solve(samples.value[j]);
        scatter.add(j, cell.pulls(samples.value[j]), cell.present(), follows);
        samples.coherence[j] = cell.coherence();
    }
    scatter.finish(samples);
    return samples;
}

} // namespace

BinSamples phase_samples(std::span<const DisplacementAccumulator> runs) {
    for (const DisplacementAccumulator& run : runs) {
        const auto& peaks = std::get<PhaseAccumulator>(DisplacementSums::of(run).sums).peaks();
        if (peaks && peaks->contrast() < least_contrast)
            throw RunError(fmt::format(
                "measure: displacement: no crystal: the largest Bragg peak is {:.3g} times the mean around "
                "it, "
                "needs {:g}; take a denser bed, a longer equilibration or the estimator lagrangian",
                peaks->contrast(), least_contrast));
    }
    const RodGrid grid = grid_of(runs[0]);
    std::vector<std::vector<double>> smoothed;
    const auto blocks = phase_blocks(runs, smoothed);
    const double far_from = DisplacementSums::of(runs[0]).far_from;
    std::vector<Vector2> guess = first_guess(blocks, grid, far_from);
    if (runs[0].layout().window)
        take_off_strain(blocks, smoothed, grid, 3.0 * lattice_spacing(runs[0].layout()), far_from, guess);
    BinSamples single = of_bins(blocks, std::move(guess), grid);
    if (runs[0].options().method == DisplacementMethod::density)
        return single; // has been averaged over a window already
    const double spacing = lattice_spacing(runs[0].layout());
    const BinSamples plain = of_cells(blocks, CellWindow(single, nullptr, grid, spacing), grid);

    // Differences across the cell are taken out, so the means belong to the middles of the bins.
    BinSamples samples = of_cells(blocks, CellWindow(single, &plain, grid, spacing), grid);
    for (std::size_t j = 0; j < grid.bins(); ++j)
        samples.place[j] = {grid.x_of(j), grid.y_of(j)};
    return samples;
}

PhaseAccumulator::PhaseAccumulator(const Layout& layout, const DisplacementOptions& options)
    : layout_(layout), options_(options), grid_(grid_seen_by(options.rod, layout, options.spacing)),
      blocks_(grid_.bins(), channels, options.block) {
    if (layout.window && options.method == DisplacementMethod::density)
        throw InputError("measure: displacement: the estimator density needs a periodic box; take phase or "
                         "lagrangian in a window");
}

bool PhaseAccumulator::add(const Frame& frame) {
    if (!layout_.window) {
        if (!peaks_)
            peaks_ = find_peaks(frame.x, frame.y, layout_.box);
        return take(frame, peaks_->G, *peaks_);
    }

    // In a window the frame waits for the others of its block of time.
    if (!waiting_.empty() &&
        std::floor(frame.time / options_.block) != std::floor(waiting_.front().time / options_.block))
        finish();
    const FarField far(frame, layout_, options_.far_from);
    std::size_t count = 0;
    for (std::size_t i = 0; i < frame.x.size(); ++i)
        count += far.has(frame.x[i], frame.y[i]);
    if (count < least_far)
        return false;
    waiting_.push_back(frame);
    return true;
}

void PhaseAccumulator::finish() {
    if (waiting_.empty())
        return;
    const FarLattice lattice = far_lattice(waiting_, layout_, options_.far_from);
    if (!peaks_)
        peaks_ = lattice.peaks;
    for (const Frame& frame : waiting_)
        take(frame, lattice.at(frame.time), lattice.peaks);
    block_peaks_.resize(blocks_.all().size(), lattice.peaks);
    waiting_.clear();
}

bool PhaseAccumulator::take(const Frame& frame, const std::array<Vector2, 3>& G, const BraggPeaks& peaks) {
    waves_.resize(frame.x.size());
    for (std::size_t i = 0; i < frame.x.size(); ++i)
        waves_[i] = plane_waves(G, frame.x[i], frame.y[i]);

    // The far field's mean phases become 0 by these factors.
    const FarField far(frame, layout_, options_.far_from);
    PhaseFactors reference{};
    for (std::size_t i = 0; i < frame.x.size(); ++i)
        if (far.has(frame.x[i], frame.y[i]))
            for (std::size_t k = 0; k < 3; ++k)
                reference[k] += waves_[i][k];
    for (auto& phase : reference) {
        if (phase == 0.0)
            return false;
        phase = std::conj(phase) / std::abs(phase);
    }

    // Each bead counts in the bin where the rod sees it.
    const RodPosition position = place_of(options_.rod, layout_, frame);
    const RodView rod(position, image_box(layout_));
    BlockSums& block = blocks_.at(frame.time, position.heading);
    const auto turned = seen_along(peaks.G, block.first_heading);
    for (std::size_t i = 0; i < frame.x.size(); ++i) {
        const RelativePosition now = rod.at(frame.x[i], frame.y[i]);
        const auto bin = grid_.bin(now.x, now.y);
        if (!bin)
            continue;
        const PhaseFactors waves =
            options_.method == DisplacementMethod::density
                ? plane_waves(turned, now.x, now.y)
                : PhaseFactors{times(waves_[i][0], reference[0]), times(waves_[i][1], reference[1]),
                               times(waves_[i][2], reference[2])};
        double* sums = block.sums.data() + *bin * channels;
        for (std::size_t k = 0; k < 3; ++k) {
            sums[2 * k] += waves[k].real();
            sums[2 * k + 1] += waves[k].imag();
        }
        sums[beads] += 1.0;
        sums[place_x] += nearest_image_once(now.x - grid_.x_of(*bin), grid_.box.x);
        sums[place_y] += nearest_image_once(now.y - grid_.y_of(*bin), grid_.box.y);
    }
    return true;
}

void PhaseAccumulator::save(StateWriter& out) const {
    measure::save(out, peaks_);
    blocks_.save(out);
    if (!layout_.window)
        return;
    out.put(block_peaks_.size());
    for (const BraggPeaks& peaks : block_peaks_)
        measure::save(out, peaks);
    out.put(waiting_.size());
    for (const Frame& frame : waiting_) { // of a bed: all beads, all rods
        out.put(frame.time);
        out.put(frame.x);
        out.put(frame.y);
        for (const RodPosition& rod : frame.rods)
            for (const double value : {rod.x, rod.y, rod.heading})
                out.put(value);
    }
}

void PhaseAccumulator::load(StateReader& in) {
    peaks_ = load_peaks(in);
    blocks_.load(in);
    block_peaks_.clear();
    waiting_.clear();
    if (!layout_.window)
        return;
    for (std::size_t left = in.count(); left > 0; --left)
        block_peaks_.push_back(load_peaks(in).value_or(BraggPeaks{}));
    for (std::size_t left = in.count(); left > 0; --left) {
        Frame frame;
        frame.time = in.get();
        frame.x = in.array(layout_.beads);
        frame.y = in.array(layout_.beads);
        for (std::size_t r = 0; r < layout_.rods; ++r) {
            const double x = in.get(), y = in.get();
            frame.rods.push_back({x, y, in.get()});
        }
        waiting_.push_back(std::move(frame));
    }
}

void save(StateWriter& out, const std::optional<BraggPeaks>& peaks) {
    out.put(std::size_t{peaks ? 1U : 0U});
    if (!peaks)
        return;
    for (std::size_t k = 0; k < 3; ++k)
        for (const double value : {static_cast<double>(peaks->m[k]), static_cast<double>(peaks->n[k]),
                                   peaks->G[k].x, peaks->G[k].y, peaks->strength[k]})
            out.put(value);
    out.put(peaks->liquid_strength);
}

std::optional<BraggPeaks> load_peaks(StateReader& in) {
    if (in.count() == 0)
        return std::nullopt;
    BraggPeaks peaks;
    for (std::size_t k = 0; k < 3; ++k) {
        peaks.m[k] = static_cast<int>(in.get());
        peaks.n[k] = static_cast<int>(in.get());
        peaks.G[k] = {in.get(), in.get()};
        peaks.strength[k] = in.get();
    }
    peaks.liquid_strength = in.get();
    return peaks;
}

} // namespace rodwake::measure
