#include "rodwake/core/parallel.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/elastic/wake_field.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/csv.hpp"
#include "run/cost_parts.hpp"
#include "run/stage_kind.hpp"
#include "wake_fields.hpp"

#include <Eigen/Core>
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>
#include <span>

namespace rodwake::app {

namespace {
using elastic::FieldValues;

std::vector<double> evenly_spaced(double from, double to, std::size_t count) {
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i)
        values[i] = i + 1 == count
                        ? to
                        : from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1);
    return values;
}

/// Of one rod, heading along x.
struct RodField {
    std::optional<PeriodicBox> box;
    std::shared_ptr<const elastic::Wake> wake;

    /// NaN at the rod itself, where the field is singular: figures leave that point out.
    FieldValues at(double x, double y, elastic::FieldRequest request) const {
        return elastic::is_singular(x, y, box) ? elastic::unrequested() : wake->at(x, y, request);
    }
};

/// A stored quantity of the grid: name, power of the length unit it scales with, and how to get it.
struct GridQuantity {
    const char* name;
    int length_power;
    double (*of)(const FieldValues&);
};

constexpr GridQuantity quantities[] = {
    {"Ux", 1, [](const FieldValues& f) { return f.displacement.x; }},
    {"Uy", 1, [](const FieldValues& f) { return f.displacement.y; }},
    {"exx", 0, [](const FieldValues& f) { return f.strain.xx; }},
    {"exy", 0, [](const FieldValues& f) { return f.strain.xy; }},
    {"eyy", 0, [](const FieldValues& f) { return f.strain.yy; }},
    {"lapx", -1, [](const FieldValues& f) { return f.laplacian.x; }},
    {"lapy", -1, [](const FieldValues& f) { return f.laplacian.y; }},
    {"gradx_tr", -1, [](const FieldValues& f) { return f.gradient_of_trace.x; }},
    {"grady_tr", -1, [](const FieldValues& f) { return f.gradient_of_trace.y; }},
    {"axis_value", 0, [](const FieldValues& f) { return elastic::extensional_axis(f.strain).value; }},
    {"axis_angle", 0, [](const FieldValues& f) { return elastic::extensional_axis(f.strain).angle; }},
};

std::string unit_name(const GridQuantity& quantity, const OutputUnits& units) {
    if (std::string_view(quantity.name) == "axis_angle")
        return "rad";
    return quantity.length_power == 0
               ? "1"
               : (quantity.length_power > 0 ? units.length_name : "1/(" + units.length_name + ")");
}

std::vector<double> scaled(std::vector<double> values, double by) {
    for (double& value : values)
        value *= by;
    return values;
}

void store_grid(Session& session, const RodField& field) {
    const scene::Field& table = *session.plan.scene.field;
    const OutputUnits& units = session.units;
    const auto x = evenly_spaced(table.x[0], table.x[1], static_cast<std::size_t>(table.nx));
    const auto y = evenly_spaced(table.y[0], table.y[1], static_cast<std::size_t>(table.ny));
    // A column for each stored quantity, in the units of files; x varies fastest. Not set to zero before: on
    // grids of millions of points that takes longer than the field, and hears no signal.
    Eigen::ArrayXXd values(x.size() * y.size(), std::size(quantities));
    parallel_for(y.size(), session.context.thread_count(), [&](std::size_t row) {
        for (std::size_t column = 0; column < x.size() && !session.context.stopped(); ++column) {
            const auto here =
                field.at(x[column], y[row], {.displacement = true, .strain = true, .polar = true});
            const auto point = static_cast<Eigen::Index>(row * x.size() + column);
            for (std::size_t q = 0; q < std::size(quantities); ++q) {
                const int power = quantities[q].length_power;
                const double factor = power == 0 ? 1.0 : power > 0 ? units.length : 1.0 / units.length;
                values(point, static_cast<Eigen::Index>(q)) = quantities[q].of(here) * factor;
            }
        }
    });
    if (session.context.stopped())
        return; // part of a grid is no grid
    session.results.dataset("/field/grid/x", scaled(x, units.length), {x.size()}, units.length_name);
    session.results.dataset("/field/grid/y", scaled(y, units.length), {y.size()}, units.length_name);
    for (std::size_t q = 0; q < std::size(quantities); ++q)
        session.results.dataset(
            std::string("/field/grid/") + quantities[q].name,
            std::span(values.col(static_cast<Eigen::Index>(q)).data(), x.size() * y.size()),
            {y.size(), x.size()}, unit_name(quantities[q], units));
}

void store_cut(Session& session, const RodField& field, std::size_t index) {
    const scene::Cut& cut = session.plan.scene.field->cuts[index];
    const OutputUnits& units = session.units;
    const std::vector<double> s = evenly_spaced(cut.from, cut.to, static_cast<std::size_t>(cut.count));
    std::vector<double> ux, uy;
    for (const double value : s) {
        const auto [x, y] = cut.along == "x" ? std::pair(value, cut.at) : std::pair(cut.at, value);
        const FieldValues f = field.at(x, y, {.displacement = true});
        ux.push_back(f.displacement.x * units.length);
        uy.push_back(f.displacement.y * units.length);
    }
    const auto position = scaled(s, units.length);
    const std::string group = fmt::format("/field/cuts/{}", index);
    session.results.dataset(group + "/s", position, {s.size()}, units.length_name);
    session.results.dataset(group + "/Ux", ux, {s.size()}, units.length_name);
    session.results.dataset(group + "/Uy", uy, {s.size()}, units.length_name);
    session.results.attribute(group, "along", cut.along);
    session.results.attribute(group, "at", cut.at * units.length);
    const std::vector<std::string> names = {cut.along, "Ux", "Uy"};
    const std::vector<std::vector<double>> columns = {position, ux, uy};
    session.directory.write(fmt::format("field_cut_{}.csv", index), store::to_csv(names, columns));
}

StageEnd run_field(Session& session) {
    const scene::Field& table = *session.plan.scene.field;
    WakeFields fields(session);
    const auto wakes = fields.of(session.modelled());
    const RodField field{wakes->box(), wakes->wake(0.0)};
    if (!table.x.empty())
        store_grid(session, field);
    for (std::size_t i = 0; i < table.cuts.size() && !session.context.stopped(); ++i)
        store_cut(session, field, i);
    if (session.context.stopped())
        return StageEnd::interrupted;
    session.log->debug("field: {} grid points, {} cuts", table.x.empty() ? 0 : table.nx * table.ny,
                       table.cuts.size());
    return StageEnd::finished;
}

std::string field_cost(const scene::Scene& scene) {
    const elastic::Medium medium{scene.medium->eta, scene.medium->xi};
    const auto wake = elastic::exact_field(medium, scene.medium->periodic)->wake(0.0);
    constexpr elastic::FieldRequest all{.displacement = true, .strain = true, .polar = true};
    constexpr int timed = 20;
    const double each = seconds_of(
                            [&] {
                                for (int i = 0; i < timed; ++i)
                                    wake->at(0.15 * i - 1.0, 0.7, all);
                            },
                            0.5 * cost_budget) /
                        timed;
    const long points = scene.field->nx * scene.field->ny;
    return fmt::format("  field map: {} points of {} in the exact field, about {}\n", points,
                       duration_text(each), duration_text(each * static_cast<double>(points)));
}

constexpr ColumnInfo cut_columns[] = {{"x", "{length}", "position along the cut"},
                                      {"y", "{length}", "position along the cut"},
                                      {"Ux", "{length}", "displacement along the rod's heading"},
                                      {"Uy", "{length}", "displacement across the rod's heading"}};

} // namespace

StageKind field_stage() {
    return {
        .stage = Stage::field,
        .has_table = [](const scene::Scene& s) { return s.field.has_value(); },
        .wanted = [](const scene::Scene& s) { return s.field.has_value(); },
        .key =
            [](const scene::Scene& s) {
                scene::Scene key = key_of_field(s);
                key.field = s.field;
                return scene::to_plain_toml(key);
            },
        .files =
            [] {
                return std::vector<FileKind>{
                    {"field_cut_<k>.csv", Lifetime::result, "displacement along a line", cut_columns}};
            },
        .read = read_field_file,
        .run = run_field,
        .cost = [](const Plan& plan, const std::filesystem::path&,
                   const RunContext&) { return plan.scene.field->x.empty() ? "" : field_cost(plan.scene); },
        .outdated = has_new_field,
        .datasets = true};
}

} // namespace rodwake::app
