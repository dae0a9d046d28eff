// Drift of the bed under its rods, drag rate, screening length and Peclet number.

#include "rodwake/measure/mechanics.hpp"

#include "measure_parts.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::assembly::measures {

namespace {

using measure::MechanicsAccumulator, measure::MechanicsResult, measure::RodPushes;
using scene::Measure, scene::Scene;

constexpr ValueInfo values[] = {
    {"force", "Force on the bed", "\u00b5N", "momentum handed over by all rods, a second", 1e6},
    {"drift", "Drift of the bed", "a/s", "of the beads' centre of mass along that force"},
    {"drag_rate", "Drag rate $\\zeta/nm$", "1/s", "force over mass of the beads and drift"},
    {"speed", "Speed through the bed", "a/s", "of the rod along its heading, the drift taken off"},
    {"shear_speed", "Transverse sound $c_T$", "a/s", "used for the screening length"},
    {"screening_length", "Screening length $\\xi$", "a", "$c_T^2/(\\gamma v)$"},
    {"box", "Shorter side of the box", "a", "the screening length is to be seen beside it"},
    {"peclet", "Peclet number", "", "shorter side of the box over $\\xi$"},
    {"verdict", "Wake in this box", "", "what the box can hold of it", 1.0, true},
    {"travelled_before", "Way before measuring", "a", "of the rod; the least of the runs"},
    {"travelled", "Way while measured", "a", "of the rod; the least of the runs"},
    {"wanted_travel", "Way to a steady wake", "a",
     "the lesser of $\\xi$ and half the box; asked before and while measuring"},
    {"steady", "", "", "whether both ways are long enough"},
    {"blocks", "", "", "of time, for the errors"},
};

constexpr SeriesInfo series[] = {{{"drag_rate", "1/s", "drag rate of the bed on the plates"}},
                                 {{"screening_length", "a", "c_T^2/(drag rate v)"}}};

void include(const Scene& scene, MeasurePlan& plan) {
    include_sums<MechanicsAccumulator>(plan, "mechanics", measure::MechanicsOptions{scene.measure->block});
}

/// Adds what rod k pushed; `advance` is of the measured rod.
void add_rod(RodPushes& pushes, const RunTables& run, std::size_t k, bool measured) {
    const auto name = [k](const char* column) { return fmt::format("{}{}", column, k); };
    const std::vector<Column> all = run.tracks({"t", name("x"), name("y"), name("theta"), name("pushed")});
    const Column &t = all[0], &x = all[1], &y = all[2], &theta = all[3], &pushed = all[4];
    double px = 0.0, py = 0.0, advance = 0.0;
    std::size_t row = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
        if (t[i] < -1e-12) // the rods are held
            continue;
        if (row > 0) {
            const double heading = 0.5 * (theta[i - 1] + theta[i]), c = std::cos(heading),
                         s = std::sin(heading);
            px += (pushed[i] - pushed[i - 1]) * c;
            py += (pushed[i] - pushed[i - 1]) * s;
            advance += (x[i] - x[i - 1]) * c + (y[i] - y[i - 1]) * s;
        }
        if (row == pushes.impulse_x.size()) {
            pushes.time.push_back(t[i]);
            pushes.impulse_x.push_back(0.0);
            pushes.impulse_y.push_back(0.0);
            pushes.advance.push_back(0.0);
        }
        pushes.impulse_x[row] += px;
        pushes.impulse_y[row] += py;
        if (measured)
            pushes.advance[row] = advance;
        ++row;
    }
}

std::vector<RodPushes> pushes_of(const MeasuredCase& data) {
    std::vector<RodPushes> runs;
    for (const RunTables& run : data.tables) {
        RodPushes pushes;
        for (std::size_t k = 0; k < data.scene.granular->rods.size(); ++k)
            add_rod(pushes, run, k, k == static_cast<std::size_t>(data.scene.measure->rod));
        runs.push_back(std::move(pushes));
    }
    return runs;
}

/// m/s; count 0 where nothing tells it.
Estimate shear_speed_of(const MeasuredCase& data) {
    if (data.scene.measure->shear_speed)
        return {*data.scene.measure->shear_speed, 0.0, 1};
    for (const auto& [name, report] : data.earlier)
        if (name == "phonons")
            for (const NamedValue& value : report.values)
                if (value.name == "c_T")
                    return std::get<Estimate>(value.value).scaled(data.bead_radius());
    return {};
}

/// What makes a run too short; nothing if it is long enough.
std::string shortness(const MechanicsResult& r, double a) {
    return r.steady
               ? ""
               : fmt::format("; too short for a steady wake: {:.3g} a before measuring and {:.3g} a after, "
                             "{:.3g} a wanted of each",
                             r.before / a, r.along / a, r.wanted / a);
}

std::string verdict_of(const MechanicsResult& r, double box, double a) {
    if (r.drag_rate.count == 0)
        return "not known: the bed does not drift along the rods' push";
    if (r.screening.count == 0)
        return "not known: it takes a speed of transverse sound (measure.phonons or measure.shear_speed)";
    if (r.screening.value > box)
        return fmt::format(
            "screening length {:.4g} a exceeds the box of {:.4g} a: the far wake is that of an "
            "elastic medium in a periodic box, and its |x|^(-1/2) tail cannot show",
            r.screening.value / a, box / a);
    return fmt::format("screening length {:.4g} a is within the box of {:.4g} a", r.screening.value / a,
                       box / a);
}

Values values_of(const MechanicsResult& r, const Estimate& shear_speed, double box, double a) {
    const double to_a = 1.0 / a;
    return {{"force", r.force},
            {"drift", r.drift.scaled(to_a)},
            {"drag_rate", r.drag_rate},
            {"speed", r.speed.scaled(to_a)},
            {"shear_speed", shear_speed.scaled(to_a)},
            {"screening_length", r.screening.scaled(to_a)},
            {"box", box * to_a},
            {"peclet", r.peclet},
            {"verdict", verdict_of(r, box, a) + shortness(r, a)},
            {"travelled_before", r.before * to_a},
            {"travelled", r.along * to_a},
            {"wanted_travel", r.wanted * to_a},
            {"steady", r.steady},
            {"blocks", count_value(r.blocks)}};
}

std::string line_of(const MechanicsResult& r, double box, double a) {
    return fmt::format("drift {} a/s, drag rate {} /s, screening length {} a in a box of {:.4g} a{}",
                       text(r.drift.scaled(1.0 / a)), text(r.drag_rate), text(r.screening.scaled(1.0 / a)),
                       box / a, shortness(r, a));
}

MeasureReport report(const MeasuredCase& data) {
    if (data.tables.empty())
        throw InputError("measure: mechanics needs tracks.csv of the granular run: it cannot be had of "
                         "measure.trajectory alone");
    const auto runs = measure::take<MechanicsAccumulator>(data.sums, "mechanics");
    const double a = data.bead_radius(), box = runs.front().layout().box.shorter();
    const Estimate shear_speed = shear_speed_of(data);
    const MechanicsResult r = measure::reduce(runs, pushes_of(data), shear_speed);
    return {.values = values_of(r, shear_speed, box, a),
            .series = {{"drag_rate", r.drag_rate}, {"screening_length", r.screening.scaled(1.0 / a)}},
            .line = line_of(r, box, a)};
}

} // namespace

MeasureKind mechanics() {
    return {.name = "mechanics",
            .order = 80,
            .wanted = [](const Measure& m) { return m.mechanics; },
            .describe = [](const Scene&) -> std::string {
                return "drift of the bed, drag rate, screening length beside the box";
            },
            .include = include,
            .reset_late_keys = [](Measure& m) { m.shear_speed = std::nullopt; },
            .report = report,
            .values = values,
            .series = series};
}

} // namespace rodwake::assembly::measures
