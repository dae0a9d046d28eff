#include "rodwake/core/error.hpp"
#include "rodwake/measure/flow.hpp"

#include <cmath>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
using Runs = std::span<const FlowAccumulator>;

std::vector<const FlowAccumulator::Block*> all_blocks(Runs runs) {
    std::vector<const FlowAccumulator::Block*> blocks;
    for (const FlowAccumulator& run : runs)
        for (const FlowAccumulator::Block& block : run.blocks())
            blocks.push_back(&block);
    return blocks;
}

void check(Runs runs) {
    if (runs.empty())
        throw InputError("measure: flow: no runs");
    for (const FlowAccumulator& run : runs)
        if (!(run.options() == runs[0].options()) || !(run.layout() == runs[0].layout()))
            throw InputError("measure: flow: the runs were measured with different options or beds");
    if (all_blocks(runs).empty())
        throw InputError(
            "measure: flow: no two frames a lag apart: write frames more often, run longer or choose a "
            "shorter lag");
}

FlowField empty_field(const RodGrid& grid) {
    FlowField field;
    field.grid = grid;
    for (Row* row :
         {&field.vx, &field.vy, &field.sigma_x, &field.sigma_y, &field.unit_x, &field.unit_y, &field.count})
        row->assign(grid.bins(), 0.0);
    return field;
}

void set_bin(FlowField& field, std::size_t bin, const std::vector<const FlowAccumulator::Block*>& blocks) {
    Row vx, vy, weights;
    double ux = 0.0, uy = 0.0;
    for (const FlowAccumulator::Block* block : blocks) {
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

/// Mean displacement of the marked beads of a run along the rod's first heading.
double drag_of(const FlowAccumulator& run, const std::vector<MarkedBead>& beads) {
    const double c = std::cos(run.first_heading()), s = std::sin(run.first_heading());
    double sum = 0.0;
    for (const MarkedBead& bead : beads)
        sum += c * (bead.x1 - bead.x0) + s * (bead.y1 - bead.y0);
    return sum / static_cast<double>(beads.size());
}

void set_drag(FlowField& field, Runs runs) {
    Row drags, shares;
    for (const FlowAccumulator& run : runs) {
        const std::vector<MarkedBead> beads = run.marked();
        if (beads.empty() || run.frames() < 2)
            continue;
        drags.push_back(drag_of(run, beads));
        if (run.rod_travel() >= run.layout().bead_radius)
            shares.push_back(drags.back() / run.rod_travel());
    }
    field.drag = mean_of_blocks(drags);
    field.drag_share = mean_of_blocks(shares);
}

} // namespace

FlowField reduce(Runs runs) {
    check(runs);
    FlowField field = empty_field(runs[0].grid());
    const auto blocks = all_blocks(runs);
    for (std::size_t bin = 0; bin < field.grid.bins(); ++bin)
        set_bin(field, bin, blocks);
    field.marked = runs[0].marked();
    set_drag(field, runs);
    field.near_speed = near_speed(field, 6.0 * runs[0].layout().bead_radius);
    field.blocks = blocks.size();
    for (const FlowAccumulator& run : runs)
        field.frames += run.frames();
    return field;
}

} // namespace rodwake::measure
