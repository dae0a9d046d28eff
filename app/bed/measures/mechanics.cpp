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

std::vector<RodPushes> pushes_of(const MeasuredCase& data, const measure::Layout& layout) {
    const double mass = static_cast<double>(layout.beads) * layout.bead_mass;
    const scene::Granular& bed = *data.scene.granular;
    const bool rods = !bed.rods.empty();
    if (rods && data.tables.empty())
        throw InputError("measure: mechanics needs tracks.csv of the granular run: it cannot be had of "
                         "measure.trajectory alone");
    std::vector<RodPushes> runs;
    for (std::size_t r = 0; r < data.sums.size(); ++r) {
        RodPushes& pushes = runs.emplace_back();
        for (std::size_t k = 0; k < bed.rods.size(); ++k)
            add_rod(pushes, data.tables[r], k, k == static_cast<std::size_t>(data.scene.measure->rod));
        if (!rods) { // a steady push through all of it
            pushes.time = {0.0, bed.duration};
            pushes.impulse_x = pushes.impulse_y = {0.0, 0.0};
        }
        // The uniform body force acts from t = 0 on.
        for (std::size_t i = 0; bed.body_force && i < pushes.time.size(); ++i) {
            const double impulse = mass * bed.body_force->acceleration * pushes.time[i];
            pushes.impulse_x[i] += impulse * std::cos(bed.body_force->direction);
            pushes.impulse_y[i] += impulse * std::sin(bed.body_force->direction);
        }
    }
    return runs;
}

/// What measure.inertia_factor says.
std::optional<Estimate> given_inertia(const Measure& m) {
    if (!m.inertia_factor)
        return std::nullopt;
    return Estimate{*m.inertia_factor, m.inertia_error.value_or(0.0), 1}; // without an error: as if exact
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

double only_if(bool known, double value) { return known ? value : std::nan(""); }

struct MechanicsValues : MechanicsResult {
    Estimate shear_speed;
    Inertia used;
    double box, a; ///< m
    double to_a = 1.0 / a;

    /// Null without a rod.
    double of_rod(double value) const { return only_if(speed.count > 0, value); }

    static constexpr auto fields() {
        using R = MechanicsValues;
        return std::tuple{
            field("force", {"Force on the bed", "\u00b5N"},
                  {"N", "momentum handed over by all rods or the body force, a second"}, &R::force),
            field("drift", {"Drift of the bed"}, {"a/s", "of the beads' centre of mass along that force"},
                  [](const R& r) { return r.drift.scaled(r.to_a); }),
            field("drag_rate", {"Drag rate $\\zeta/nm$"}, {"1/s", "force over mass of the beads and drift"},
                  &R::drag_rate),
            field("speed", {"Speed through the bed"},
                  {"a/s", "of the rod along its heading, the drift taken off"},
                  [](const R& r) { return r.speed.scaled(r.to_a); }),
            field("shear_speed", {"Transverse sound $c_T$"}, {"a/s", "used for the screening length"},
                  [](const R& r) { return r.shear_speed.scaled(r.to_a); }),
            field("screening_length", {"Screening length $\\xi$"}, {"a", "$m^* c_T^2/(\\gamma v)$"},
                  [](const R& r) { return r.screening.scaled(r.to_a); }),
            field("box", {"Shorter side of the box"}, {"a", "the screening length is to be seen beside it"},
                  [](const R& r) { return r.box * r.to_a; }),
            field("peclet", {"Peclet number"}, {"1", "shorter side of the box over $\\xi$"}, &R::peclet),
            field("verdict", {"Wake in this box"}, {"", "what the box can hold of it"},
                  [](const R& r) { return verdict_of(r, r.box, r.a) + shortness(r, r.a); }),
            field("travelled_before", {"Way before measuring"}, {"a", "of the rod; the least of the runs"},
                  [](const R& r) { return r.of_rod(r.before * r.to_a); }),
            field("travelled", {"Way while measured"}, {"a", "of the rod; the least of the runs"},
                  [](const R& r) { return r.of_rod(r.along * r.to_a); }),
            field("wanted_travel", {"Way to a steady wake"},
                  {"a", "the lesser of $\\xi$ and half the box; required before and while measuring"},
                  [](const R& r) { return r.of_rod(r.wanted * r.to_a); }),
            field("steady", &R::steady, {"1", "whether both ways are long enough"}),
            field("blocks", &R::blocks, {"1", "of time, for the errors"}),
            field("decay_rate", {"Decay rate of the drift"},
                  {"1/s", "of its own fluctuations; $\\zeta/(m^* nm)$"},
                  [](const R& r) { return r.decay.rate; }),
            field("decay_absence", {"", "why there is no decay rate"},
                  [](const R& r) { return r.decay.absence; }),
            field("decay_lag_low", {"s", "first lag of the balance that the decay rate is from"},
                  [](const R& r) { return only_if(r.decay.rate.count > 0, r.decay.lag_low); }),
            field("decay_lag_high", {"s", "last lag of it"},
                  [](const R& r) { return only_if(r.decay.rate.count > 0, r.decay.lag_high); }),
            field("force_coupling", {"1", "part of the drag in that balance that the rods' force makes up"},
                  [](const R& r) { return only_if(r.decay.inertia.count > 0, r.decay.coupling); }),
            field("inertia", {"Inertia over mass $m^*$"},
                  {"1", "drag rate by the push over decay rate of the drift"},
                  [](const R& r) { return r.decay.inertia; }),
            field("used_inertia", {"$m^*$ that is used"},
                  {"1", "in the screening length (null: none, the mass of the beads)"},
                  [](const R& r) { return r.used.factor; }),
            field("inertia_source", {"", "where that comes from"}, [](const R& r) { return r.used.source; })};
    }
};

MeasureReport report(const MeasuredCase& data) {
    const Inertia used = inertia_of(data); // before the sums are taken
    const auto runs = measure::take<MechanicsAccumulator>(data.sums, "mechanics");
    const double a = data.bead_radius(), box = runs.front().layout().box.shorter();
    const auto& given_speed = data.scene.measure->shear_speed; // else that of phonons; count 0: unknown
    const Estimate shear_speed = given_speed ? Estimate{*given_speed, 0.0, 1} : data.row.c_T.scaled(a);
    const MechanicsResult r = measure::reduce(runs, pushes_of(data, runs.front().layout()), shear_speed,
                                              given_inertia(*data.scene.measure));
    const std::string inertia = r.decay.inertia.count > 0 ? ", m* " + text(r.decay.inertia) : "";
    const MechanicsValues f = {r, shear_speed, used, box, a};
    data.row.drag_rate = r.drag_rate;
    data.row.screening_length = r.screening.scaled(f.to_a);
    data.row.decay_rate = r.decay.rate;
    data.row.inertia = r.decay.inertia;
    return {.values = record_json(f),
            .line =
                fmt::format("drift {} a/s, drag rate {} /s{}, screening length {} a in a box of {:.4g} a{}",
                            text(r.drift.scaled(1.0 / a)), text(r.drag_rate), inertia,
                            text(r.screening.scaled(1.0 / a)), box / a, shortness(r, a))};
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
            .reset_postprocessing_keys =
                [](Measure& m) { m.shear_speed = m.inertia_factor = m.inertia_error = std::nullopt; },
            .report = report,
            .values = values_of<MechanicsValues, true>};
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
        const measure::DriftDecay decay =
            measure::measured_decay(runs, measures::pushes_of(data, runs.front().layout()));
        if (measure::usable_inertia(decay.inertia))
            return {decay.inertia, "measured by mechanics"};
        const std::string why = !decay.absence.empty() ? decay.absence
                                : decay.inertia.count == 0
                                    ? "no drag rate by a push"
                                    : "measured as " + text(decay.inertia) + ", which is not known to 20 %";
        return {{}, "none, so the bare mass of the beads: " + why};
    } catch (const std::runtime_error& error) { // phonons go on without it
        return {{}, fmt::format("none, so the bare mass of the beads: {}", error.what())};
    }
}

} // namespace rodwake::app
