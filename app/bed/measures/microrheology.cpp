// Mean-square displacement of the beads, the stiffness of what holds them and its memory.

#include "rodwake/measure/microrheology.hpp"
#include "rodwake/measure/memory_kernel.hpp"

#include "bed/measure_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace rodwake::app::measures {

namespace {

using measure::MemoryKernel, measure::MicrorheologyAccumulator, measure::MicrorheologyResult,
    measure::StiffnessSpectrum;
using scene::Measure, scene::Scene;

constexpr ValueInfo values[] = {
    {"stiffness", "Stiffness", "a^-2", R"($1/(s \tilde{\Delta}(s))$ for $s \to 0$)"},
    {"spring", "Spring constant", "\u00b5N/m", "of what holds a bead: $4mT_{xy}$ times the stiffness", 1e6},
    {"s_low", "Extrapolated from", "1/s", "lowest $s$ used"},
    {"s_high", "Extrapolated to", "1/s", "highest $s$ used"},
    {"temperature", "$T_{xy}$", "m^2/s^2", "of the measured frames"},
    {"kernel_low", "Memory kernel from", "1/s", "lowest $s$ at which the run is long enough for 2 %"},
    {"kernel_high", "Memory kernel to", "1/s", "highest $s$ at which frames are close enough for 2 %"},
    {"inertia_share", "Inertia at that $s$", "", "$ms^2$ over $4mT_{xy}/(s\\tilde{\\Delta})$"},
    {"bead_drag", "Drag on a bead", "1/s", "$\\Gamma/m$ as given, which the kernel is without"},
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
constexpr ColumnInfo kernel_columns[] = {
    {"s", "1/s", "Laplace frequency"},
    {"total", "N/m", "4 m T_xy/(s MSD~(s)) = m s^2 + Gamma s + k~(s)"},
    {"total_error", "N/m", "standard error, also that of with_drag; empty: unknown"},
    {"bias", "N/m", "how far the length of the run and the frames may put these values off"},
    {"with_drag", "N/m", "k~(s) + Gamma s: total less m s^2"},
    {"kernel", "N/m", "memory kernel k~(s), less measure.bead_drag; empty: no drag was given"},
    {"kernel_error", "N/m", "standard error; empty: unknown"}};
constexpr FileInfo files[] = {{"msd.csv", "mean-square displacement of the beads", msd_columns},
                              {"stiffness.csv", "stiffness from microrheology", stiffness_columns},
                              {"memory_kernel.csv", "memory kernel from microrheology", kernel_columns}};

constexpr SeriesInfo series[] = {{{"stiffness", "1/a^2", "1/(s MSD~(s)) at s -> 0"}}};

void reset_late_keys(Measure& m) {
    m.s_low = m.s_high = std::nullopt;
    m.bead_drag = m.bead_drag_error = std::nullopt;
}

void include(const Scene& scene, MeasurePlan& plan) {
    include_sums<MicrorheologyAccumulator>(
        plan, "microrheology",
        measure::MicrorheologyOptions{0.0, scene.measure->s_low, scene.measure->s_high});
}

std::optional<Estimate> drag_of(const Measure& m) {
    if (!m.bead_drag)
        return std::nullopt;
    return Estimate{*m.bead_drag, m.bead_drag_error.value_or(unknown_error), 1};
}

Value number_or_none(const std::optional<double>& number) { return number ? Value(*number) : Value(); }

/// Of all that resists at the upper end of the range, how much is the inertia that is taken off.
Value inertia_share(const StiffnessSpectrum& spectrum, const MemoryKernel& kernel) {
    if (!spectrum.high)
        return {};
    const auto at = std::ranges::find(kernel.s, *spectrum.high) - kernel.s.begin();
    return 1.0 - kernel.with_drag[at] / kernel.total[at];
}

Values kernel_values(const StiffnessSpectrum& spectrum, const MemoryKernel& kernel, const Measure& m) {
    const std::optional<Estimate> drag = drag_of(m);
    return {{"kernel_low", number_or_none(spectrum.low)},
            {"kernel_high", number_or_none(spectrum.high)},
            {"inertia_share", inertia_share(spectrum, kernel)},
            {"bead_drag", drag ? Value(*drag) : Value()}};
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

MeasureTable kernel_table(const MemoryKernel& k) {
    return {"memory_kernel.csv",
            "memory kernel of what holds a bead in N/m against s in 1/s",
            kernel_columns,
            {k.s, k.total, k.total_error, k.bias, k.with_drag, k.kernel, k.kernel_error}};
}

std::string line_of(const MicrorheologyResult& r, const Estimate& stiffness, bool drag) {
    const std::string range = r.spectrum.low ? fmt::format("{} from s = {:.3g} to {:.3g} 1/s",
                                                           drag ? "memory kernel" : "kernel with drag",
                                                           *r.spectrum.low, *r.spectrum.high)
                                             : "memory kernel at no s within 2 %";
    return fmt::format("stiffness {} /a^2, spring {} N/m, {}", text(stiffness), text(r.spring), range);
}

MicrorheologyResult reduced(const MeasuredCase& data, std::span<const MicrorheologyAccumulator> runs) {
    MicrorheologyResult r = measure::reduce(runs);
    if (!data.tables.empty())
        r.use_temperature(mean_of(of_summaries(data, "T_xy", "T_xy")).value);
    return r;
}

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius(), area = 1.0 / (a * a);
    const auto runs = measure::take<MicrorheologyAccumulator>(data.sums, "microrheology");
    const MicrorheologyResult r = reduced(data, runs);
    const Estimate stiffness = r.stiffness_zero.scaled(a * a);
    const Measure& keys = *data.scene.measure;
    const MemoryKernel kernel =
        measure::memory_kernel(r.spectrum, runs[0].layout().bead_mass, r.temperature, drag_of(keys));
    Values found = values_of(r, a);
    for (NamedValue& value : kernel_values(r.spectrum, kernel, keys))
        found.push_back(std::move(value));
    return {.values = std::move(found),
            .tables = {{"msd.csv",
                        "mean-square displacement, drift removed; lag in s, msd in a^2",
                        msd_columns,
                        {r.lag, scaled(r.msd, area), scaled(r.msd_error, area), r.origins}},
                       {"stiffness.csv",
                        "1/(s MSD~(s)) in 1/a^2; s in 1/s",
                        stiffness_columns,
                        {r.s, scaled(r.stiffness, a * a), scaled(r.stiffness_error, a * a)}},
                       kernel_table(kernel)},
            .series = {{"stiffness", stiffness}},
            .line = line_of(r, stiffness, keys.bead_drag.has_value())};
}

} // namespace

MeasureKind microrheology() {
    return {.name = "microrheology",
            .order = 20,
            .wanted = [](const Measure& m) { return m.microrheology; },
            .describe = [](const Scene&) -> std::string {
                return "mean-square displacement, stiffness and memory kernel of the beads";
            },
            .include = include,
            .reset_late_keys = reset_late_keys,
            .report = report,
            .values = values,
            .files = files,
            .series = series};
}

} // namespace rodwake::app::measures
