// Drift of the bed under its rods or a uniform force, drag rate, inertia, screening length and Peclet number.

#include "rodwake/measure/mechanics.hpp"

#include "bed/measure_parts.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app::measures {

namespace {

using measure::MechanicsAccumulator, measure::MechanicsResult, measure::RodPushes;
using scene::Measure, scene::Scene;

constexpr ValueInfo values[] = {
    {"force", "Force on the bed", "\u00b5N", "momentum handed over by all rods or the body force, a second",
     1e6},
    {"drift", "Drift of the bed", "a/s", "of the beads' centre of mass along that force"},
    {"drag_rate", "Drag rate $\\zeta/nm$", "1/s", "force over mass of the beads and drift"},
    {"speed", "Speed through the bed", "a/s", "of the rod along its heading, the drift taken off"},
    {"shear_speed", "Transverse sound $c_T$", "a/s", "used for the screening length"},
    {"decay_rate", "Decay rate of the drift", "1/s", "of its own fluctuations; $\\zeta/(m^* nm)$"},
    {"decay_absence", "", "", "why there is no decay rate", 1.0, true},
    {"decay_lag_low", "", "s", "first lag of the balance that the decay rate is from"},
    {"decay_lag_high", "", "s", "last lag of it"},
    {"force_coupling", "", "", "part of the drag in that balance that the rods' force makes up"},
    {"inertia", "Inertia over mass $m^*$", "", "drag rate by the push over decay rate of the drift"},
    {"used_inertia", "$m^*$ that is used", "", "in the screening length; null: none, the mass of the beads"},
    {"inertia_source", "", "", "where that comes from", 1.0, true},
    {"screening_length", "Screening length $\\xi$", "a", "$m^* c_T^2/(\\gamma v)$"},
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
                                 {{"screening_length", "a", "m* c_T^2/(drag rate v)"}},
                                 {{"decay_rate", "1/s", "decay rate of the bed's drift"}},
                                 {{"inertia", "1", "inertia of the drift over mass, m*"}}};

/// Every frame that is measured, those of currents too: a drift decays fast.
void include(const Scene& scene, MeasurePlan& plan) {
    plan.sums.include("mechanics", measure::Accumulator(MechanicsAccumulator(
                                       plan.sums.layout(), measure::MechanicsOptions{scene.measure->block})));
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

/// Of the uniform body force, from t = 0 on.
void add_body_force(RodPushes& pushes, const Scene& scene, double mass) {
    if (!scene.granular->body_force)
        return;
    const granular::BodyForce& force = *scene.granular->body_force;
    for (std::size_t i = 0; i < pushes.time.size(); ++i) {
        const double impulse = mass * force.acceleration * pushes.time[i];
        pushes.impulse_x[i] += impulse * std::cos(force.direction);
        pushes.impulse_y[i] += impulse * std::sin(force.direction);
    }
}

/// Of one run; without rods a steady push through all of it.
RodPushes pushes_of(const Scene& scene, const RunTables* run, double mass) {
    RodPushes pushes;
    const std::size_t rods = scene.granular->rods.size();
    for (std::size_t k = 0; k < rods; ++k)
        add_rod(pushes, *run, k, k == static_cast<std::size_t>(scene.measure->rod));
    if (rods == 0) {
        pushes.time = {0.0, scene.granular->duration};
        pushes.impulse_x = pushes.impulse_y = {0.0, 0.0};
    }
    add_body_force(pushes, scene, mass);
    return pushes;
}

std::vector<RodPushes> pushes_of(const MeasuredCase& data, const measure::Layout& layout) {
    const double mass = static_cast<double>(layout.beads) * layout.bead_mass;
    const bool rods = !data.scene.granular->rods.empty();
    if (rods && data.tables.empty())
        throw InputError("measure: mechanics needs tracks.csv of the granular run: it cannot be had of "
                         "measure.trajectory alone");
    std::vector<RodPushes> runs;
    for (std::size_t r = 0; r < data.sums.size(); ++r)
        runs.push_back(pushes_of(data.scene, rods ? &data.tables[r] : nullptr, mass));
    return runs;
}

/// What measure.inertia_factor says.
std::optional<Estimate> given_inertia(const Measure& m) {
    if (!m.inertia_factor)
        return std::nullopt;
    return Estimate{*m.inertia_factor, m.inertia_error.value_or(0.0), 1}; // without an error: as if exact
}

Inertia inertia_by(const measure::DriftDecay& decay) {
    if (measure::usable_inertia(decay.inertia))
        return {decay.inertia, "measured by mechanics"};
    const std::string why = !decay.absence.empty() ? decay.absence
                            : decay.inertia.count == 0
                                ? "no drag rate by a push"
                                : "measured as " + text(decay.inertia) + ", which is not known to 20 %";
    return {{}, "none, so the bare mass of the beads: " + why};
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
    if (r.speed.count == 0)
        return r.steady ? ""
                        : fmt::format("; measured from too early on: the drift takes {:.2g} s to be steady "
                                      "(measure.from)",
                                      3.0 / r.drag_rate.value);
    return r.steady
               ? ""
               : fmt::format("; too short for a steady wake: {:.3g} a before measuring and {:.3g} a after, "
                             "{:.3g} a wanted of each",
                             r.before / a, r.along / a, r.wanted / a);
}

std::string verdict_of(const MechanicsResult& r, double box, double a) {
    if (r.drag_rate.count == 0)
        return "not known: the bed does not drift along a push";
    if (r.speed.count == 0)
        return "not known: there is no rod";
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

/// Null without a rod.
Value of_rod(const MechanicsResult& r, double value) { return r.speed.count > 0 ? Value(value) : Value(); }

void add_decay(Values& out, const measure::DriftDecay& decay, const Inertia& used) {
    out.push_back({"decay_rate", decay.rate});
    out.push_back({"decay_absence", decay.absence});
    const bool known = decay.rate.count > 0;
    out.push_back({"decay_lag_low", known ? Value(decay.lag_low) : Value()});
    out.push_back({"decay_lag_high", known ? Value(decay.lag_high) : Value()});
    out.push_back({"force_coupling", decay.inertia.count > 0 ? Value(decay.coupling) : Value()});
    out.push_back({"inertia", decay.inertia});
    out.push_back({"used_inertia", used.factor});
    out.push_back({"inertia_source", used.source});
}

Values values_of(const MechanicsResult& r, const Estimate& shear_speed, const Inertia& used, double box,
                 double a) {
    const double to_a = 1.0 / a;
    Values out = {{"force", r.force},
                  {"drift", r.drift.scaled(to_a)},
                  {"drag_rate", r.drag_rate},
                  {"speed", r.speed.scaled(to_a)},
                  {"shear_speed", shear_speed.scaled(to_a)},
                  {"screening_length", r.screening.scaled(to_a)},
                  {"box", box * to_a},
                  {"peclet", r.peclet},
                  {"verdict", verdict_of(r, box, a) + shortness(r, a)},
                  {"travelled_before", of_rod(r, r.before * to_a)},
                  {"travelled", of_rod(r, r.along * to_a)},
                  {"wanted_travel", of_rod(r, r.wanted * to_a)},
                  {"steady", r.steady},
                  {"blocks", count_value(r.blocks)}};
    add_decay(out, r.decay, used);
    return out;
}

std::string line_of(const MechanicsResult& r, double box, double a) {
    const std::string inertia = r.decay.inertia.count > 0 ? ", m* " + text(r.decay.inertia) : "";
    return fmt::format("drift {} a/s, drag rate {} /s{}, screening length {} a in a box of {:.4g} a{}",
                       text(r.drift.scaled(1.0 / a)), text(r.drag_rate), inertia,
                       text(r.screening.scaled(1.0 / a)), box / a, shortness(r, a));
}

MeasureReport report(const MeasuredCase& data) {
    const Inertia used = inertia_of(data); // before the sums are taken
    const auto runs = measure::take<MechanicsAccumulator>(data.sums, "mechanics");
    const double a = data.bead_radius(), box = runs.front().layout().box.shorter();
    const Estimate shear_speed = shear_speed_of(data);
    const MechanicsResult r = measure::reduce(runs, pushes_of(data, runs.front().layout()), shear_speed,
                                              given_inertia(*data.scene.measure));
    return {.values = values_of(r, shear_speed, used, box, a),
            .series = {{"drag_rate", r.drag_rate},
                       {"screening_length", r.screening.scaled(1.0 / a)},
                       {"decay_rate", r.decay.rate},
                       {"inertia", r.decay.inertia}},
            .line = line_of(r, box, a)};
}

} // namespace

MeasureKind mechanics() {
    return {.name = "mechanics",
            .order = 80,
            .wanted = [](const Measure& m) { return m.mechanics; },
            .describe = [](const Scene&) -> std::string {
                return "drift of the bed, drag rate, inertia, screening length beside the box";
            },
            .include = include,
            .reset_late_keys =
                [](Measure& m) { m.shear_speed = m.inertia_factor = m.inertia_error = std::nullopt; },
            .report = report,
            .values = values,
            .series = series};
}

} // namespace rodwake::app::measures

namespace rodwake::app {

Inertia inertia_of(const MeasuredCase& data) {
    using measures::MechanicsAccumulator;
    if (const auto given = measures::given_inertia(*data.scene.measure))
        return {*given, "measure.inertia_factor"};
    if (!data.scene.measure->mechanics)
        return {{}, "none, so the bare mass of the beads: give measure.inertia_factor, or measure mechanics"};
    std::vector<MechanicsAccumulator> runs;
    for (measure::Measures& run : data.sums)
        runs.push_back(run.find("mechanics")->as<MechanicsAccumulator>());
    try {
        return measures::inertia_by(
            measure::measured_decay(runs, measures::pushes_of(data, runs.front().layout())));
    } catch (const std::runtime_error& error) { // phonons go on without it
        return {{}, fmt::format("none, so the bare mass of the beads: {}", error.what())};
    }
}

} // namespace rodwake::app
