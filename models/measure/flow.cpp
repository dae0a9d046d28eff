#include "rodwake/measure/flow.hpp"
#include "common_beads.hpp"
#include "rod_view.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
using Runs = std::span<const FlowAccumulator>;

void set_bin(FlowField& field, std::size_t bin,
             const std::vector<const FlowAccumulator::FlowBlock*>& blocks) {
    Row vx, vy, weights;
    double ux = 0.0, uy = 0.0;
    for (const FlowAccumulator::FlowBlock* block : blocks) {
        const double count = block->count[bin];
        if (count == 0.0)
            continue;
        vx.push_back(block->vx[bin] / count);
        vy.push_back(block->vy[bin] / count);
        weights.push_back(count);
        ux += block->ux[bin];
        uy += block->uy[bin];
        field.count[bin] += count;
    }
    if (weights.empty())
        return;
    const Estimate x = mean_of_blocks(vx, weights), y = mean_of_blocks(vy, weights);
    field.vx[bin] = x.value;
    field.vy[bin] = y.value;
    field.sigma_x[bin] = x.error;
    field.sigma_y[bin] = y.error;
    field.unit_x[bin] = ux / field.count[bin];
    field.unit_y[bin] = uy / field.count[bin];
}

double near_speed(const FlowField& field, double within) {
    double sum = 0.0, count = 0.0;
    for (std::size_t bin = 0; bin < field.grid.bins(); ++bin) {
        if (std::hypot(field.grid.x_of(bin), field.grid.y_of(bin)) > within)
            continue;
        sum += field.count[bin] * std::hypot(field.vx[bin], field.vy[bin]);
        count += field.count[bin];
    }
    return count > 0.0 ? sum / count : 0.0;
}

} // namespace

FlowField reduce(Runs runs) {
    if (runs.empty())
        throw InputError("measure: flow: no runs");
    std::vector<const FlowAccumulator::FlowBlock*> blocks;
    for (const FlowAccumulator& run : runs) {
        if (!(run.options() == runs[0].options()) || !(run.layout() == runs[0].layout()))
            throw InputError("measure: flow: the runs were measured with different options or beds");
        for (const FlowAccumulator::FlowBlock& block : run.blocks())
            blocks.push_back(&block);
    }
    if (blocks.empty())
        throw InputError(
            "measure: flow: no two frames a lag apart: write frames more often, run longer or choose another "
            "lag (measure.flow_lag)");
    const RodGrid& grid = runs[0].grid();
    FlowField field;
    field.grid = grid;
    for (Row* row :
         {&field.vx, &field.vy, &field.sigma_x, &field.sigma_y, &field.unit_x, &field.unit_y, &field.count})
        row->assign(grid.bins(), 0.0);
    for (std::size_t bin = 0; bin < field.grid.bins(); ++bin)
        set_bin(field, bin, blocks);
    field.marked = runs[0].marked();
    Row drags, shares;
    for (const FlowAccumulator& run : runs) {
        // The drag is the mean displacement of marked beads along the rod's first heading.
        const double c = std::cos(run.first_heading()), s = std::sin(run.first_heading());
        double sum = 0.0, seen = 0.0;
        for (const MarkedBead& bead : run.marked())
            if (!std::isnan(bead.x1)) {
                sum += c * (bead.x1 - bead.x0) + s * (bead.y1 - bead.y0);
                seen += 1.0;
            }
        if (seen == 0.0 || run.frames() < 2)
            continue;
        drags.push_back(sum / seen);
        if (run.rod_travel() >= run.layout().bead_radius)
            shares.push_back(drags.back() / run.rod_travel());
    }
    field.drag = mean_of_blocks(drags);
    field.drag_share = mean_of_blocks(shares);
    field.near_speed = near_speed(field, 6.0 * runs[0].layout().bead_radius);
    field.blocks = blocks.size();
    for (const FlowAccumulator& run : runs)
        field.frames += run.frames();
    return field;
}

namespace {

void want(bool legal, const char* what, double value, const char* range) {
    if (!legal)
        throw InputError(fmt::format("measure: flow, {} {:g}: must be {}", what, value, range));
}

} // namespace

FlowAccumulator::FlowAccumulator(const Layout& layout, const FlowOptions& options)
    : layout_(layout), options_(options) {
    validate(layout);
    if (options.rod >= layout.rods)
        throw InputError(
            fmt::format("measure: flow around rod {}: there are {} rods", options.rod + 1, layout.rods));
    want(std::isfinite(options.lag) && options.lag >= 0.0, "lag (s)", options.lag, "finite and not negative");
    want(std::isfinite(options.block) && options.block > 0.0 && options.block >= options.lag, "block (s)",
         options.block, "finite, positive and at least the lag");
    want(options.marked_within >= 0.0 && options.marked_within <= layout.box.shorter() / 2.0,
         "marked_within (m)", options.marked_within, "from 0 to half the box");
    want(std::isfinite(options.marked_travel) && options.marked_travel >= 0.0, "marked_travel (m)",
         options.marked_travel, "finite and not negative");
    grid_ = grid_seen_by(options.rod, layout, options.spacing);
}

void FlowAccumulator::start(const Past& now) {
    started_ = true;
    last_rod_ = now.rod;
    first_heading_ = now.rod.heading;
    const PeriodicBox images = image_box(layout_);
    const RodView view(now.rod, images);
    const double within2 = options_.marked_within * options_.marked_within;
    for (std::size_t i = 0; i < now.x.size(); ++i)
        if (view.distance2(into_box(now.x[i], images.x), into_box(now.y[i], images.y)) < within2) {
            marked_.push_back(now.bead.empty() ? i : now.bead[i]);
            first_x_.push_back(now.x[i]);
            first_y_.push_back(now.y[i]);
        }
    last_x_ = first_x_;
    last_y_ = first_y_;
}

void FlowAccumulator::follow_marked(const Past& now) {
    if (options_.marked_travel > 0.0 && travel_ >= options_.marked_travel)
        return;
    const MeanStep step(past_.back(), now);
    drift_x_ += step.x;
    drift_y_ += step.y;
    since_x_ += step.x;
    since_y_ += step.y;
    if (now.rod.known()) {
        travel_ += (now.rod.x - last_rod_.x - since_x_) * std::cos(last_rod_.heading) +
                   (now.rod.y - last_rod_.y - since_y_) * std::sin(last_rod_.heading);
        last_rod_ = now.rod;
        since_x_ = since_y_ = 0.0;
    }
    for (std::size_t k = 0; k < marked_.size(); ++k) {
        // Without names all beads are there, since a frame without beads is passed over.
        const auto found = std::ranges::lower_bound(now.bead, marked_[k]);
        const bool seen = now.bead.empty() || (found != now.bead.end() && *found == marked_[k]);
        const std::size_t at =
            now.bead.empty() ? marked_[k] : static_cast<std::size_t>(found - now.bead.begin());
        last_x_[k] = seen ? now.x[at] - drift_x_ : std::nan("");
        last_y_[k] = seen ? now.y[at] - drift_y_ : std::nan("");
    }
}

void FlowAccumulator::add(const Frame& frame) {
    check_frame(layout_, frame);
    times_.next(frame.time, "flow", layout_.grid);
    BeadPlaces positions = places_of(frame);
    if (positions.x.empty())
        return;
    Past now{frame.time,
             times_.tick,
             std::move(positions.x),
             std::move(positions.y),
             frame.rods[options_.rod],
             std::move(positions.bead)};
    if (started_)
        follow_marked(now);
    else if (now.rod.known())
        start(now);
    if (!past_.empty()) {
        const bool on_grid = times_.interval > 0.0;
        const auto wanted = static_cast<std::size_t>(
            on_grid ? std::max(1.0, std::round(options_.lag / times_.interval)) : 1.0);
        const double lag = options_.lag > 0.0 ? options_.lag : now.time - past_.back().time;
        const auto off = [&](const Past& past) {
            return on_grid ? std::abs(static_cast<double>(now.tick - past.tick) - static_cast<double>(wanted))
                           : std::abs(now.time - past.time - lag) / lag;
        };
        const auto before = std::ranges::min_element(past_, {}, off);
        if (off(*before) <= (on_grid ? 0.0 : 0.5) && before->rod.known() && now.rod.known())
            take(*before, now);
        std::erase_if(past_, [&](const Past& past) { // the last one tells the drift
            const bool is_old = on_grid ? now.tick - past.tick >= wanted : now.time - past.time > 1.5 * lag;
            return is_old && &past != &past_.back();
        });
    }
    past_.push_back(std::move(now));
}

void FlowAccumulator::take(const Past& before, const Past& now) {
    const double lag = now.time - before.time;
    const MeanStep step(before, now);
    const PeriodicBox images = image_box(layout_);
    const RodView view(
        RodPosition{(before.rod.x + now.rod.x) / 2.0, (before.rod.y + now.rod.y) / 2.0,
                    before.rod.heading +
                        std::remainder(now.rod.heading - before.rod.heading, 2.0 * std::numbers::pi) / 2.0},
        images);
    const double number = std::floor((before.time + now.time) / 2.0 / options_.block);
    if (blocks_.empty() || number != block_number_) {
        const Row zero(grid_.bins(), 0.0);
        blocks_.push_back({zero, zero, zero, zero, zero});
        block_number_ = number;
    }
    FlowBlock& block = blocks_.back();
    for_each_common_bead(now, before, [&](std::size_t i, std::size_t j) {
        const RelativePosition position = view.at(into_box((before.x[j] + now.x[i]) / 2.0, images.x),
                                                  into_box((before.y[j] + now.y[i]) / 2.0, images.y));
        const auto bin = grid_.bin(position.x, position.y);
        if (!bin)
            return;
        const RelativePosition v =
            view.turned((now.x[i] - before.x[j] - step.x) / lag, (now.y[i] - before.y[j] - step.y) / lag);
        const double speed = std::sqrt(v.x * v.x + v.y * v.y);
        block.vx[*bin] += v.x;
        block.vy[*bin] += v.y;
        block.ux[*bin] += speed > 0.0 ? v.x / speed : 0.0;
        block.uy[*bin] += speed > 0.0 ? v.y / speed : 0.0;
        block.count[*bin] += 1.0;
    });
}

std::vector<MarkedBead> FlowAccumulator::marked() const {
    std::vector<MarkedBead> beads;
    for (std::size_t k = 0; k < marked_.size(); ++k)
        beads.push_back({marked_[k], first_x_[k], first_y_[k], last_x_[k], last_y_[k]});
    return beads;
}

void FlowAccumulator::save(StateWriter& out) const {
    times_.save(out);
    for (const double value : {block_number_, first_heading_, travel_, drift_x_, drift_y_})
        out.put(value);
    out.put(Row(marked_.begin(), marked_.end()));
    for (const Row* row : {&first_x_, &first_y_, &last_x_, &last_y_})
        out.put(*row);
    out.put(past_.size());
    for (const Past& past : past_) {
        for (const double value : {past.time, past.rod.x, past.rod.y, past.rod.heading})
            out.put(value);
        out.put(past.x);
        out.put(past.y);
    }
    out.put(blocks_.size());
    for (const FlowBlock& block : blocks_)
        for (const Row* row : {&block.vx, &block.vy, &block.ux, &block.uy, &block.count})
            out.put(*row);
}

void FlowAccumulator::load(StateReader& in) {
    times_.load(in);
    for (double* value : {&block_number_, &first_heading_, &travel_, &drift_x_, &drift_y_})
        *value = in.get();
    marked_.clear();
    for (const double bead : in.array()) {
        if (!(bead >= 0.0 && bead < static_cast<double>(layout_.beads)))
            throw RunError(fmt::format("measure: flow: marked bead {} of {}", bead, layout_.beads));
        marked_.push_back(static_cast<std::size_t>(bead));
    }
    for (Row* row : {&first_x_, &first_y_, &last_x_, &last_y_})
        *row = in.array(marked_.size());
    past_.clear();
    for (std::size_t left = in.count(); left > 0; --left) {
        Past past;
        for (double* value : {&past.time, &past.rod.x, &past.rod.y, &past.rod.heading})
            *value = in.get();
        past.x = in.array(layout_.beads);
        past.y = in.array(layout_.beads);
        past_.push_back(std::move(past));
    }
    for (std::size_t k = 0; k < past_.size(); ++k)
        past_[k].tick = times_.frames - past_.size() + k;
    if (past_.empty() && times_.frames > 0)
        throw RunError("measure: flow: the last frames are missing");
    started_ = !past_.empty(); // of a bed: its rods are in every frame
    if (started_)
        last_rod_ = past_.back().rod;
    blocks_.clear();
    for (std::size_t left = in.count(); left > 0; --left) {
        FlowBlock block;
        for (Row* row : {&block.vx, &block.vy, &block.ux, &block.uy, &block.count})
            *row = in.array(grid_.bins());
        blocks_.push_back(std::move(block));
    }
}

} // namespace rodwake::measure
