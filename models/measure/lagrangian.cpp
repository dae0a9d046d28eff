#include "blocks.hpp"
#include "common_beads.hpp"
#include "displacement_impl.hpp"
#include "estimators.hpp"
#include "phase_cell.hpp"

#include <array>
#include <cmath>
#include <numeric>

namespace rodwake::measure {

namespace {

// Of the box, ahead of the rod.
constexpr double zone_begin = 0.3, zone_end = 0.45, first_zone_begin = 0.15, left_zone = 0.25,
                 uncertain = 0.03; // about zone_end
constexpr std::size_t most_waiting = 512;

double mean_place(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

} // namespace

LagrangianAccumulator::LagrangianAccumulator(const Layout& layout, const DisplacementOptions& options)
    : layout_(layout), options_(options), grid_(grid_seen_by(options.rod, layout, options.spacing)),
      blocks_(grid_.bins(), channels, options.block) {}

void LagrangianAccumulator::add(const Frame& frame) {
    const RodPosition position = place_of(options_.rod, layout_, frame);
    const RodView rod(position, image_box(layout_));
    if (samples_.empty()) {
        const std::size_t beads_known = layout_.all_beads > 0 ? layout_.all_beads : layout_.beads;
        for (auto* values : {&place_x_, &place_y_, &samples_, &in_zone_})
            values->assign(beads_known, 0.0);
        waiting_.assign(beads_known, {});
        if (layout_.all_beads == 0) {
            first_x_ = mean_place(frame.unwrapped_x);
            first_y_ = mean_place(frame.unwrapped_y);
        }
        for_each_named(frame, [&](std::size_t bead, std::size_t at) {
            place_x_[bead] = frame.unwrapped_x[at];
            place_y_[bead] = frame.unwrapped_y[at];
            const double ahead = rod.at(frame.x[at], frame.y[at]).x / side();
            samples_[bead] = ahead > first_zone_begin && ahead < zone_end ? 1.0 : 0.0;
        });
    }

    // The drift is the mean step of all beads.
    if (layout_.all_beads == 0) {
        drift_x_ = mean_place(frame.unwrapped_x) - first_x_;
        drift_y_ = mean_place(frame.unwrapped_y) - first_y_;
    } else if (BeadPlaces now = places_of(frame); !now.x.empty()) {
        const MeanStep step(last_, now);
        drift_x_ += step.x;
        drift_y_ += step.y;
        last_ = std::move(now);
    }
    const auto block =
        static_cast<std::size_t>(&blocks_.at(frame.time, position.heading) - blocks_.all().data());
    const RodPosition rod_without_drift{position.x - drift_x_, position.y - drift_y_, position.heading};
    for_each_named(frame, [&](std::size_t bead, std::size_t at) {
        take(bead,
             {frame.unwrapped_x[at] - drift_x_, frame.unwrapped_y[at] - drift_y_, rod_without_drift, block});
    });
}

void LagrangianAccumulator::take(std::size_t bead, const Sample& sample) {
    const PeriodicBox images = image_box(layout_);
    const RodView rod(sample.rod, images);
    const double ahead = rod.at(into_box(sample.x, images.x), into_box(sample.y, images.y)).x / side();
    const bool in_zone = ahead > zone_begin && ahead < zone_end;
    if (in_zone && in_zone_[bead] == 0.0) {
        place_x_[bead] = place_y_[bead] = samples_[bead] = 0.0;
        in_zone_[bead] = 1.0;
    }
    if (in_zone) {
        place_x_[bead] += sample.x;
        place_y_[bead] += sample.y;
        samples_[bead] += 1.0;
    }
    if (in_zone_[bead] == 1.0 && ahead >= left_zone) {
        if (waiting_[bead].size() < most_waiting)
            waiting_[bead].push_back(sample);
        return;
    }
    in_zone_[bead] = 0.0;
    for (const Sample& before : waiting_[bead])
        count(bead, before);
    waiting_[bead].clear();
    if (samples_[bead] > 0.0)
        count(bead, sample);
}

void LagrangianAccumulator::count(std::size_t bead, const Sample& sample) {
    const double x = place_x_[bead] / samples_[bead], y = place_y_[bead] / samples_[bead];
    const PeriodicBox images = image_box(layout_);
    const RodView rod(sample.rod, images);
    const RelativePosition before = rod.at(into_box(x, images.x), into_box(y, images.y));
    const auto bin = grid_.bin(before.x, before.y);
    if (!bin || std::abs(before.x / side() - zone_end) < uncertain)
        return;
    const RelativePosition moved = rod.turned(sample.x - x, sample.y - y);
    double* sum = blocks_.sums(sample.block).data() + *bin * channels;
    sum[along] += moved.x;
    sum[across] += moved.y;
    sum[beads] += 1.0;
    sum[place_x] += nearest_image_once(before.x - grid_.x_of(*bin), grid_.box.x);
    sum[place_y] += nearest_image_once(before.y - grid_.y_of(*bin), grid_.box.y);
}

void LagrangianAccumulator::save(StateWriter& out) const {
    for (const auto* values : {&place_x_, &place_y_, &samples_, &in_zone_})
        out.put(std::span<const double>(*values));
    for (const double value : {first_x_, first_y_, drift_x_, drift_y_})
        out.put(value);
    for (const std::vector<Sample>& samples : waiting_) {
        out.put(samples.size());
        for (const Sample& sample : samples) {
            for (const double value : {sample.x, sample.y, sample.rod.x, sample.rod.y, sample.rod.heading})
                out.put(value);
            out.put(sample.block);
        }
    }
    blocks_.save(out);
}

void LagrangianAccumulator::load(StateReader& in) {
    place_x_ = in.array();
    const std::size_t beads_known = place_x_.size(); // none before the first frame
    for (auto* values : {&place_y_, &samples_, &in_zone_})
        *values = in.array(beads_known);
    for (double* value : {&first_x_, &first_y_, &drift_x_, &drift_y_})
        *value = in.get();
    waiting_.assign(beads_known, {});
    for (std::vector<Sample>& samples : waiting_)
        for (std::size_t left = in.count(); left > 0; --left) {
            Sample& sample = samples.emplace_back();
            for (double* value : {&sample.x, &sample.y, &sample.rod.x, &sample.rod.y, &sample.rod.heading})
                *value = in.get();
            sample.block = in.count();
        }
    blocks_.load(in);
}

namespace {

using Lagrangian = LagrangianAccumulator;
using ChannelSums = std::array<double, Lagrangian::channels>;

struct Sources {
    std::vector<const BlockSums*> blocks;
    std::vector<Follows> follows;
};

/// Value and place (from the bin's middle) of the mean; adds to the scatter.
void put(const Sources& sources, std::size_t bin, const std::vector<CellPart>& parts, BinSamples& samples,
         BlockScatter& scatter) {
    std::vector<ChannelSums> blocks;
    ChannelSums total{};
    for (const BlockSums* block : sources.blocks) {
        // ChannelSums of a block over some bins, the displacements of each bin taken back by what U differs
        // there.
        ChannelSums of_block{};
        for (const CellPart& part : parts) {
            const double* from = &block->sums[part.bin * Lagrangian::channels];
            for (std::size_t c = 0; c < Lagrangian::channels; ++c)
                of_block[c] += part.weight * from[c];
            of_block[Lagrangian::along] -= part.weight * from[Lagrangian::beads] * part.difference.x;
            of_block[Lagrangian::across] -= part.weight * from[Lagrangian::beads] * part.difference.y;
        }
        blocks.push_back(of_block);
        for (std::size_t c = 0; c < Lagrangian::channels; ++c)
            total[c] += of_block[c];
    }
    const double beads = total[Lagrangian::beads];
    const Vector2 mean{total[Lagrangian::along] / beads, total[Lagrangian::across] / beads};
    std::vector<Vector2> pulls;
    std::vector<bool> present;
    for (const ChannelSums& block : blocks) {
        pulls.push_back({(block[Lagrangian::along] - block[Lagrangian::beads] * mean.x) / beads,
                         (block[Lagrangian::across] - block[Lagrangian::beads] * mean.y) / beads});
        present.push_back(block[Lagrangian::beads] > 0.0);
    }
    samples.value[bin] = mean;
    samples.coherence[bin] = 1.0;
    samples.place[bin].x += total[Lagrangian::place_x] / beads;
    samples.place[bin].y += total[Lagrangian::place_y] / beads;
    scatter.add(bin, pulls, present, sources.follows);
}

Vector2 middle(const RodGrid& grid, std::size_t bin) { return {grid.x_of(bin), grid.y_of(bin)}; }

BinSamples of_cells(const Sources& sources, const CellWindow& window, const RodGrid& grid) {
    BinSamples samples(grid.bins());
    BlockScatter scatter(grid.bins());
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        const CellMean mean = window.around(j);
        samples.count[j] = mean.count;
        if (!mean.parts.empty())
            put(sources, j, mean.parts, samples, scatter);
        samples.place[j] = {middle(grid, j).x + mean.place.x, middle(grid, j).y + mean.place.y};
    }
    scatter.finish(samples);
    return samples;
}

} // namespace

BinSamples lagrangian_samples(std::span<const DisplacementAccumulator> runs) {
    const RodGrid grid = grid_of(runs[0]);
    const double spacing = lattice_spacing(runs[0].layout());
    Sources sources;
    for (const DisplacementAccumulator& run : runs)
        for (const BlockSums* before = nullptr;
             const BlockSums& block : std::get<Lagrangian>(DisplacementSums::of(run).sums).blocks()) {
            sources.follows.push_back(follows_of(before, block));
            sources.blocks.push_back(&block);
            before = &block;
        }
    BinSamples single(grid.bins());
    BlockScatter scatter(grid.bins());
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        single.place[j] = middle(grid, j);
        for (const BlockSums* block : sources.blocks)
            single.count[j] += block->sums[j * Lagrangian::channels + Lagrangian::beads];
        if (single.count[j] > 0.0)
            put(sources, j, {{j, 1.0, {}}}, single, scatter);
    }
    scatter.finish(single);
    const BinSamples plain = of_cells(sources, CellWindow(single, nullptr, grid, spacing), grid);
    BinSamples samples = of_cells(sources, CellWindow(single, &plain, grid, spacing), grid);
    for (std::size_t j = 0; j < grid.bins(); ++j) // differences across the cell were taken out
        samples.place[j] = middle(grid, j);
    return samples;
}

} // namespace rodwake::measure
