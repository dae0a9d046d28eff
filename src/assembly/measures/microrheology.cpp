// Mean-square displacement of the beads and the stiffness of what holds them.

#include "rodwake/measure/microrheology.hpp"

#include "measure_parts.hpp"

#include <fmt/format.h>

namespace rodwake::assembly::measures {

namespace {

using measure::MicrorheologyAccumulator, measure::MicrorheologyResult;
using scene::Measure, scene::Scene;

constexpr ValueInfo values[] = {
    {"stiffness", "Stiffness", "a^-2", R"($1/(s \tilde{\Delta}(s))$ for $s \to 0$)"},
    {"spring", "Spring constant", "\u00b5N/m", "of what holds a bead: $4mT_{xy}$ times the stiffness", 1e6},
    {"s_low", "Extrapolated from", "1/s", "lowest $s$ used"},
    {"s_high", "Extrapolated to", "1/s", "highest $s$ used"},
    {"temperature", "$T_{xy}$", "m^2/s^2", "of the measured frames"},
    {"scatter", "", "a^-2", "part of the error of the stiffness: from noise"},
    {"bend", "", "a^-2", "part of the error of the stiffness: from the bend of the curve in the window"},
    {"window_narrowed", "", "", "whether there were too few lags for the wanted window"},
    {"frames", "", "", "measured"},
};

constexpr ColumnInfo msd_columns[] = {{"lag", "s", "time between two places of a bead"},
                                      {"msd", "a^2", "mean-square displacement, drift removed"},
                                      {"sigma", "a^2", "standard error; empty: unknown"},
                                      {"origins", "1", "starting times behind the value"}};
constexpr ColumnInfo stiffness_columns[] = {{"s", "1/s", "Laplace frequency"},
                                            {"value", "1/a^2", "1/(s MSD~(s))"},
                                            {"sigma", "1/a^2", "standard error; empty: unknown"}};
constexpr FileInfo files[] = {{"msd.csv", "mean-square displacement of the beads", msd_columns},
                              {"stiffness.csv", "stiffness from microrheology", stiffness_columns}};

constexpr SeriesInfo series[] = {{{"stiffness", "1/a^2", "1/(s MSD~(s)) at s -> 0"}}};

void include(const Scene& scene, MeasurePlan& plan) {
    include_sums<MicrorheologyAccumulator>(
        plan, "microrheology",
        measure::MicrorheologyOptions{0.0, scene.measure->s_low, scene.measure->s_high});
}

Values values_of(const MicrorheologyResult& r, double a) {
    return {{"stiffness", r.stiffness_zero.scaled(a * a)},
            {"scatter", r.scatter * a * a}, // the two parts of its error
            {"bend", r.bend * a * a},
            {"spring", r.spring},
            {"s_low", r.s_low},
            {"s_high", r.s_high},
            {"window_narrowed", r.window_narrowed},
            {"temperature", r.temperature},
            {"frames", count_value(r.frames)}};
}

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius(), area = 1.0 / (a * a);
    MicrorheologyResult r =
        measure::reduce(measure::take<MicrorheologyAccumulator>(data.sums, "microrheology"));
    if (!data.tables.empty())
        r.use_temperature(mean_of(of_summaries(data, "T_xy", "T_xy")).value);
    const Estimate stiffness = r.stiffness_zero.scaled(a * a);
    return {.values = values_of(r, a),
            .tables = {{"msd.csv",
                        "mean-square displacement, drift removed; lag in s, msd in a^2",
                        msd_columns,
                        {r.lag, scaled(r.msd, area), scaled(r.msd_error, area), r.origins}},
                       {"stiffness.csv",
                        "1/(s MSD~(s)) in 1/a^2; s in 1/s",
                        stiffness_columns,
                        {r.s, scaled(r.stiffness, a * a), scaled(r.stiffness_error, a * a)}}},
            .series = {{"stiffness", stiffness}},
            .line = fmt::format("stiffness {} /a^2, spring {} N/m", text(stiffness), text(r.spring))};
}

} // namespace

MeasureKind microrheology() {
    return {.name = "microrheology",
            .order = 20,
            .wanted = [](const Measure& m) { return m.microrheology; },
            .describe = [](const Scene&) -> std::string {
                return "mean-square displacement and stiffness of the beads";
            },
            .include = include,
            .reset_late_keys = [](Measure& m) { m.s_low = m.s_high = std::nullopt; },
            .report = report,
            .values = values,
            .files = files,
            .series = series};
}

} // namespace rodwake::assembly::measures
