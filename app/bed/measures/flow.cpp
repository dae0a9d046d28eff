// Velocity of the beads around the rod, and how far single ones are dragged.

#include "rodwake/measure/flow.hpp"

#include "bed/measure_parts.hpp"

#include <fmt/format.h>

namespace rodwake::app::measures {

namespace {

using measure::FlowAccumulator, measure::FlowField;
using scene::Measure, scene::Scene;

void include(const Scene& scene, MeasurePlan& plan) {
    const auto& m = *scene.measure;
    const double a = scene::measured_radius(scene);
    measure::FlowOptions options;
    options.rod = static_cast<std::size_t>(m.rod);
    options.spacing = m.flow_spacing.value_or(2.0 * a);
    options.lag = m.flow_lag;
    options.block = m.block;
    options.marked_within = m.marked_within.value_or(6.0 * a);
    options.marked_travel = m.marked_travel.value_or(0.0);
    include_sums<FlowAccumulator>(plan, "flow", options);
}

std::string describe(const Scene& scene) {
    return fmt::format("bead velocity over {:g} s around rod {}", scene.measure->flow_lag,
                       scene.measure->rod);
}

struct Marked {
    const measure::MarkedBead& m;
    double a; ///< m
};
using Row = const Marked&;
constexpr RowColumn<Marked> marked_columns[] = {
    {{"bead", "1", "number of the bead"}, [](Row row) { return row.m.bead; }},
    {{"x0", "a", "position in the first frame, unwrapped"}, [](Row row) { return row.m.x0 / row.a; }},
    {{"y0", "a", "position in the first frame, unwrapped"}, [](Row row) { return row.m.y0 / row.a; }},
    {{"x1", "a", "position in the last frame, drift removed"}, [](Row row) { return row.m.x1 / row.a; }},
    {{"y1", "a", "position in the last frame, drift removed"}, [](Row row) { return row.m.y1 / row.a; }}};
constexpr auto marked_infos = infos_of(marked_columns);
constexpr FileInfo files[] = {{"marked.csv", "beads near the rod, before and after", marked_infos},
                              {"flow.vti", "flow field for ParaView"}};

struct FlowValues {
    const FlowField& r;
    double a; ///< m
};
using F = const FlowValues&;

constexpr ResultValue<FlowValues> values[] = {
    {{"drag", "Beads dragged", "a", "way of the marked beads along the rod's first heading"},
     [](F f) { return f.r.drag.scaled(1.0 / f.a); }},
    {{"drag_share", "Share dragged", "", "the same over the rod's own way"},
     [](F f) { return f.r.drag_share; }},
    {{"near_speed", "Speed near the rod", "a/s", "mean of the beads' flow within 6 $a$"},
     [](F f) { return f.r.near_speed / f.a; }},
    {{"spacing", "", "a", "of the flow's grid"}, [](F f) { return f.r.grid.width / f.a; }},
    {{"blocks", "", "", "of time, for the errors"}, [](F f) { return f.r.blocks; }},
    {{"frames", "", "", "measured"}, [](F f) { return f.r.frames; }},
};
constexpr auto value_infos = infos_of(values);

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius(), to_a = 1.0 / a;
    const FlowField f = measure::reduce(measure::take<FlowAccumulator>(data.sums, "flow"));
    std::vector<Marked> rows;
    for (const measure::MarkedBead& m : f.marked)
        rows.push_back({m, a});
    return {.values = values_of(values, FlowValues{f, a}),
            .tables = {MeasureTable{
                "marked.csv",
                "of run 1: beads near the rod in the first frame, there and in the last frame, unwrapped, "
                "drift removed; a",
                marked_infos, columns_of(marked_columns, rows)}},
            .grids = {MeasureGrid{"/flow",
                                  f.grid,
                                  {{"vx", scaled(f.vx, to_a), "a/s"},
                                   {"vy", scaled(f.vy, to_a), "a/s"},
                                   {"sigma_x", scaled(f.sigma_x, to_a), "a/s"},
                                   {"sigma_y", scaled(f.sigma_y, to_a), "a/s"},
                                   {"unit_x", f.unit_x, ""},
                                   {"unit_y", f.unit_y, ""},
                                   {"count", f.count, ""}}}},
            .images = {MeasureImage{"flow.vti",
                                    f.grid,
                                    {{"velocity", 3, vectors(f.vx, f.vy, to_a)},
                                     {"unit", 3, vectors(f.unit_x, f.unit_y, 1.0)},
                                     {"count", 1, f.count}}}},
            .line = fmt::format("beads near the rod move at {:.3g} a/s and are dragged by {} of its way",
                                f.near_speed / a, text(f.drag_share))};
}

} // namespace

MeasureKind flow() {
    return {.name = "flow",
            .order = 30,
            .wanted = [](const Measure& m) { return m.flow; },
            .describe = describe,
            .include = include,
            .report = report,
            .values = value_infos,
            .files = files};
}

} // namespace rodwake::app::measures
