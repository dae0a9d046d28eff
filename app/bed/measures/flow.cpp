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

struct Marked : measure::MarkedBead {
    double a; ///< m

    static constexpr auto fields() {
        using R = Marked;
        return std::tuple{field("bead", &R::bead, {"1", "number of the bead"}),
                          field("x0", {"a", "position in the first frame, unwrapped"},
                                [](const R& r) { return r.x0 / r.a; }),
                          field("y0", {"a", "position in the first frame, unwrapped"},
                                [](const R& r) { return r.y0 / r.a; }),
                          field("x1", {"a", "position in the last frame, drift removed"},
                                [](const R& r) { return r.x1 / r.a; }),
                          field("y1", {"a", "position in the last frame, drift removed"},
                                [](const R& r) { return r.y1 / r.a; })};
    }
};

struct FlowValues : FlowField {
    double a; ///< m

    static constexpr auto fields() {
        using R = FlowValues;
        return std::tuple{
            field("drag", {"Beads dragged"}, {"a", "way of the marked beads along the rod's first heading"},
                  [](const R& r) { return r.drag.scaled(1.0 / r.a); }),
            field("drag_share", {"Share dragged"}, {"1", "the same over the rod's own way"}, &R::drag_share),
            field("near_speed", {"Speed near the rod"}, {"a/s", "mean of the beads' flow within 6 $a$"},
                  [](const R& r) { return r.near_speed / r.a; }),
            field("spacing", {"a", "of the flow's grid"}, [](const R& r) { return r.grid.width / r.a; }),
            field("blocks", &R::blocks, {"1", "of time, for the errors"}),
            field("frames", &R::frames, {"1", "measured"})};
    }
};

struct FlowLayers : FlowField {
    double a; ///< m

    static constexpr auto fields() {
        using R = FlowLayers;
        return std::tuple{field("vx", {"a/s", "velocity of the beads along the rod's heading (NaN: no bead)"},
                                [](const R& r) { return scaled(r.vx, 1.0 / r.a); }),
                          field("vy",
                                {"a/s", "velocity of the beads across the rod's heading (NaN: no bead)"},
                                [](const R& r) { return scaled(r.vy, 1.0 / r.a); }),
                          field("sigma_x", {"a/s", "standard error of vx (NaN: unknown)"},
                                [](const R& r) { return scaled(r.sigma_x, 1.0 / r.a); }),
                          field("sigma_y", {"a/s", "standard error of vy (NaN: unknown)"},
                                [](const R& r) { return scaled(r.sigma_y, 1.0 / r.a); }),
                          field("unit_x", &R::unit_x,
                                {"1", "mean of the unit vectors of the beads' velocities, along the heading; "
                                      "1: all move the same way"}),
                          field("unit_y", &R::unit_y, {"1", "the same across the heading"}),
                          field("count", &R::count, {"1", "samples behind the value"})};
    }
};

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius(), to_a = 1.0 / a;
    const FlowField f = measure::reduce(measure::take<FlowAccumulator>(data.sums, "flow"));
    std::vector<Marked> rows;
    for (const measure::MarkedBead& m : f.marked)
        rows.push_back({m, a});
    return {.values = record_json(FlowValues{f, a}),
            .tables =
                {{"marked.csv",
                  "of run 1: beads near the rod in the first frame, there and in the last frame, unwrapped, "
                  "drift removed; a",
                  csv_of(rows)}},
            .grids = {MeasureGrid{"/flow", f.grid, layers_of(FlowLayers{f, a})}},
            .images = {MeasureImage{"flow.vti",
                                    f.grid,
                                    {{"velocity", 3, vectors(f.vx, f.vy, to_a)},
                                     {"unit", 3, vectors(f.unit_x, f.unit_y, 1.0)},
                                     {"count", 1, f.count}}}},
            .line = fmt::format("beads near the rod move at {:.3g} a/s and are dragged by {} of its way",
                                f.near_speed / a, text(f.drag_share))};
}

std::vector<FileKind> files() {
    return {{"marked.csv", Lifetime::result, "beads near the rod, before and after", columns_of<Marked>()},
            {"flow.vti", Lifetime::result, "flow field for ParaView"}};
}

} // namespace

MeasureKind flow() {
    return {.name = "flow",
            .order = 30,
            .wanted = [](const Measure& m) { return m.flow; },
            .describe = describe,
            .include = include,
            .report = report,
            .values = values_of<FlowValues, true>,
            .layers = columns_of<FlowLayers>,
            .files = files};
}

} // namespace rodwake::app::measures
