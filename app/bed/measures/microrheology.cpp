// Mean-square displacement of the beads, the stiffness of what holds them and its memory.

#include "rodwake/measure/microrheology.hpp"
#include "rodwake/measure/memory_kernel.hpp"

#include "bed/measure_parts.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace rodwake::app::measures {

namespace {

using measure::MemoryKernel, measure::MicrorheologyAccumulator, measure::MicrorheologyResult,
    measure::StiffnessSpectrum;
using scene::Measure, scene::Scene;

constexpr SeriesInfo series[] = {{{"stiffness", "1/a^2", "1/(s MSD~(s)) at s -> 0"}}};

void reset_postprocessing_keys(Measure& m) {
    m.s_low = m.s_high = std::nullopt;
    m.bead_drag = m.bead_drag_error = std::nullopt;
}

/// The name under which the sums of one kind of beads are kept.
std::string kind_name(std::size_t kind) { return fmt::format("microrheology_kind{}", kind); }

void include(const Scene& scene, MeasurePlan& plan) {
    measure::MicrorheologyOptions options{0.0, scene.measure->s_low, scene.measure->s_high,
                                          scene.tracks ? scene.tracks->localisation : Localisation{}};
    include_sums<MicrorheologyAccumulator>(plan, "microrheology", options);
    for (std::size_t k = 0; k < plan.sums.layout().kind_radii.size(); ++k) {
        options.kind = k;
        include_sums<MicrorheologyAccumulator>(plan, kind_name(k).c_str(), options);
    }
}

std::optional<Estimate> drag_of(const Measure& m) {
    if (!m.bead_drag)
        return std::nullopt;
    return Estimate{*m.bead_drag, m.bead_drag_error.value_or(unknown_error), 1};
}

/// Of all that resists at the upper end of the range, how much is the inertia that is taken off.
Value inertia_share(const StiffnessSpectrum& spectrum, const MemoryKernel& kernel) {
    if (!spectrum.high || kernel.s.empty())
        return {};
    const auto at = std::ranges::find(kernel.s, *spectrum.high) - kernel.s.begin();
    return 1.0 - kernel.with_drag[at] / kernel.total[at];
}

std::string line_of(const MicrorheologyResult& r, const Estimate& stiffness, bool drag) {
    const std::string range = r.spectrum.low ? fmt::format("{} from s = {:.3g} to {:.3g} 1/s",
                                                           drag ? "memory kernel" : "kernel with drag",
                                                           *r.spectrum.low, *r.spectrum.high)
                                             : "memory kernel at no s within 2 %";
    if (r.spring.count == 0)
        return fmt::format("stiffness {} /a^2", text(stiffness));
    return fmt::format("stiffness {} /a^2, spring {} N/m, {}", text(stiffness), text(r.spring), range);
}

MicrorheologyResult reduced(const MeasuredCase& data, std::span<const MicrorheologyAccumulator> runs) {
    MicrorheologyResult r = measure::reduce(runs);
    if (!data.tables.empty() && r.spring.count > 0)
        r.use_temperature(mean_of(of_summaries(data, "T_xy", "T_xy")).value);
    return r;
}

struct MicrorheologyValues {
    const MicrorheologyResult& r;
    const MemoryKernel& kernel;
    std::optional<Estimate> drag;
    double a; ///< m
    double area = 1.0 / (a * a);
};
using F = const MicrorheologyValues&;

constexpr ResultValue<MicrorheologyValues> values[] = {
    {{"stiffness", "Stiffness", "a^-2", R"($1/(s \tilde{\Delta}(s))$ for $s \to 0$)"},
     [](F f) { return f.r.stiffness_zero.scaled(f.a * f.a); }},
    {{"scatter", "", "a^-2", "part of the error of the stiffness: from noise"},
     [](F f) { return f.r.scatter * f.a * f.a; }},
    {{"bend", "", "a^-2", "part of the error of the stiffness: from the bend of the curve in the window"},
     [](F f) { return f.r.bend * f.a * f.a; }},
    {{"spring", "Spring constant", "\u00b5N/m", "of what holds a bead: $4mT_{xy}$ times the stiffness", 1e6},
     [](F f) { return f.r.spring; }},
    {{"s_low", "Extrapolated from", "1/s", "lowest $s$ used"}, [](F f) { return f.r.s_low; }},
    {{"s_high", "Extrapolated to", "1/s", "highest $s$ used"}, [](F f) { return f.r.s_high; }},
    {{"window_narrowed", "", "", "whether there were too few lags for the wanted window"},
     [](F f) { return f.r.window_narrowed; }},
    {{"temperature", "$T_{xy}$", "m^2/s^2", "of the measured frames"},
     [](F f) { return f.r.spring.count > 0 ? Value(f.r.temperature) : Value(); }},
    {{"frames", "", "", "measured"}, [](F f) { return f.r.frames; }},
    {{"kernel_low", "Memory kernel from", "1/s", "lowest $s$ at which the run is long enough for 2 %"},
     [](F f) { return f.r.spectrum.low; }},
    {{"kernel_high", "Memory kernel to", "1/s", "highest $s$ at which frames are close enough for 2 %"},
     [](F f) { return f.r.spectrum.high; }},
    {{"inertia_share", "Inertia at that $s$", "", "$ms^2$ over $4mT_{xy}/(s\\tilde{\\Delta})$"},
     [](F f) { return inertia_share(f.r.spectrum, f.kernel); }},
    {{"bead_drag", "Drag on a bead", "1/s", "$\\Gamma/m$ as given, which the kernel is without"},
     [](F f) { return f.drag; }},
};
constexpr auto value_infos = infos_of(values);

constexpr ResultColumn<MicrorheologyValues> msd_columns[] = {
    {{"lag", "s", "time between two positions of a bead"}, [](F f) { return f.r.lag; }},
    {{"msd", "a^2", "mean-square displacement, drift removed"}, [](F f) { return scaled(f.r.msd, f.area); }},
    {{"sigma", "a^2", "standard error (empty: unknown)"}, [](F f) { return scaled(f.r.msd_error, f.area); }},
    {{"origins", "1", "starting times behind the value"}, [](F f) { return f.r.origins; }}};
constexpr ResultColumn<MicrorheologyValues> stiffness_columns[] = {
    {{"s", "1/s", "Laplace frequency"}, [](F f) { return f.r.s; }},
    {{"value", "1/a^2", "1/(s MSD~(s))"}, [](F f) { return scaled(f.r.stiffness, f.a * f.a); }},
    {{"sigma", "1/a^2", "standard error (empty: unknown)"},
     [](F f) { return scaled(f.r.stiffness_error, f.a * f.a); }}};
constexpr ResultColumn<MicrorheologyValues> kernel_columns[] = {
    {{"s", "1/s", "Laplace frequency"}, [](F f) { return f.kernel.s; }},
    {{"total", "N/m", "4 m T_xy/(s MSD~(s)) = m s^2 + Gamma s + k~(s)"}, [](F f) { return f.kernel.total; }},
    {{"total_error", "N/m", "standard error, also of with_drag (empty: unknown)"},
     [](F f) { return f.kernel.total_error; }},
    {{"bias", "N/m", "how far the length of the run and the frames may put these values off"},
     [](F f) { return f.kernel.bias; }},
    {{"with_drag", "N/m", "k~(s) + Gamma s: total less m s^2"}, [](F f) { return f.kernel.with_drag; }},
    {{"kernel", "N/m", "memory kernel k~(s), less measure.bead_drag (empty: no drag was given)"},
     [](F f) { return f.kernel.kernel; }},
    {{"kernel_error", "N/m", "standard error (empty: unknown)"}, [](F f) { return f.kernel.kernel_error; }}};
/// A row of msd_kinds.csv; of stiffness_kinds.csv without the lag.
struct KindRow {
    std::size_t kind;
    double radius, value, error, lag; ///< lengths in a
};
constexpr RowColumn<KindRow> kind_columns[] = {
    {{"kind", "1", "number in bead_kinds, from 0"}, [](const KindRow& r) { return r.kind; }},
    {{"radius", "a", "of its beads, mean"}, [](const KindRow& r) { return r.radius; }},
    {{"stiffness", "1/a^2", "1/(s MSD~(s)) at s -> 0"}, [](const KindRow& r) { return r.value; }},
    {{"sigma", "1/a^2", "standard error (empty: unknown)"}, [](const KindRow& r) { return r.error; }}};
constexpr RowColumn<KindRow> kind_msd_columns[] = {
    {{"kind", "1", "number in bead_kinds, from 0"}, [](const KindRow& r) { return r.kind; }},
    {{"lag", "s", "time between two positions of a bead"}, [](const KindRow& r) { return r.lag; }},
    {{"msd", "a^2", "mean-square displacement, drift of all beads removed"},
     [](const KindRow& r) { return r.value; }},
    {{"sigma", "a^2", "standard error (empty: unknown)"}, [](const KindRow& r) { return r.error; }}};
constexpr auto kind_infos = infos_of(kind_columns);
constexpr auto kind_msd_infos = infos_of(kind_msd_columns);
constexpr auto msd_infos = infos_of(msd_columns);
constexpr auto stiffness_infos = infos_of(stiffness_columns);
constexpr auto kernel_infos = infos_of(kernel_columns);
constexpr FileInfo files[] = {
    {"msd.csv", "mean-square displacement of the beads", msd_infos},
    {"stiffness.csv", "stiffness from microrheology", stiffness_infos},
    {"memory_kernel.csv", "memory kernel from microrheology", kernel_infos},
    {"msd_kinds.csv", "mean-square displacement of beads of several sizes, by their kinds", kind_msd_infos},
    {"stiffness_kinds.csv", "stiffness of beads of several sizes, by their kinds", kind_infos}};

/// Only tracks have these; the stage logs them.
void add_camera(const MicrorheologyResult& r, const Localisation& asked, double a, MeasureReport& report) {
    const bool is_known = r.localisation.has_value();
    const Estimate found = r.localisation.value_or(Estimate{}).scaled(1.0 / a);
    report.values.push_back({"localisation", is_known ? Value(found) : Value()});
    report.values.push_back({"taken_off", r.taken_off / (a * a)});
    if (!r.no_stiffness.empty()) {
        report.values.push_back({"no_stiffness", r.no_stiffness});
        report.line = "mean-square displacement; no stiffness: " + r.no_stiffness;
    }
    if (r.taken_off != 0.0)
        report.line +=
            fmt::format("; localisation {:.3g} a taken off", 0.5 * std::sqrt(std::abs(r.taken_off)) / a);
    if (asked.find && !is_known)
        report.line +=
            "; no correction for localisation: frames are too far apart to distinguish it from the "
            "beads' motion";
    if (!asked.find && asked.given == 0.0 && is_known && found.value > 3.0 * found.error)
        report.line += fmt::format(
            "; localisation seems to be {} a: tracks.localisation = \"auto\" takes it off", text(found));
    if (asked.find && r.taken_off != 0.0 && !(r.scatter < 0.5 * r.stiffness_zero.value))
        report.line += "; the camera's noise may hide the stiffness";
}

/// Adds the stiffness of each kind of beads; a kind without one has the reason in its line.
void add_kinds(const MeasuredCase& data, const std::vector<double>& radii, double a, MeasureReport& report) {
    std::vector<KindRow> stiffness, msd;
    for (std::size_t k = 0; k < radii.size(); ++k) {
        const auto runs = measure::take<MicrorheologyAccumulator>(data.sums, kind_name(k));
        try {
            const MicrorheologyResult r = measure::reduce(runs);
            const Estimate of_kind = r.stiffness_zero.scaled(a * a);
            for (std::size_t i = 0; i < r.lag.size(); ++i)
                msd.push_back({k, 0.0, r.msd[i] / (a * a), r.msd_error[i] / (a * a), r.lag[i]});
            if (!r.no_stiffness.empty())
                throw InputError(r.no_stiffness);
            stiffness.push_back({k, radii[k] / a, of_kind.value, of_kind.error, 0.0});
            report.line += fmt::format("; of kind {} {} /a^2", k, text(of_kind));
        } catch (const InputError& error) {
            report.line += fmt::format("; of kind {} no stiffness: {}", k, error.what());
        }
    }
    report.tables.push_back({"msd_kinds.csv",
                             "mean-square displacement by kinds of beads; lag in s, msd in a^2",
                             kind_msd_infos, columns_of(kind_msd_columns, msd)});
    report.tables.push_back({"stiffness_kinds.csv", "1/(s MSD~(s)) at s -> 0 by kinds of beads, in 1/a^2",
                             kind_infos, columns_of(kind_columns, stiffness)});
}

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius();
    const auto runs = measure::take<MicrorheologyAccumulator>(data.sums, "microrheology");
    const MicrorheologyResult r = reduced(data, runs);
    const Estimate stiffness = r.stiffness_zero.scaled(a * a);
    const std::optional<Estimate> drag = drag_of(*data.scene.measure);
    const measure::Layout& layout = runs[0].layout();
    const bool warm = layout.velocities && layout.kind_radii.empty(); // else nothing is known of forces
    const MemoryKernel kernel =
        warm ? measure::memory_kernel(r.spectrum, layout.bead_mass, r.temperature, drag) : MemoryKernel{};
    const MicrorheologyValues f = {r, kernel, drag, a};
    MeasureReport report = {
        .values = values_of(values, f),
        .tables = {{"msd.csv", "mean-square displacement, drift removed; lag in s, msd in a^2", msd_infos,
                    columns_of(msd_columns, f)},
                   {"stiffness.csv", "1/(s MSD~(s)) in 1/a^2; s in 1/s", stiffness_infos,
                    columns_of(stiffness_columns, f)},
                   {"memory_kernel.csv", "memory kernel of what holds a bead in N/m against s in 1/s",
                    kernel_infos, columns_of(kernel_columns, f)}},
        .line = line_of(r, stiffness, drag.has_value())};
    if (!warm)
        report.tables.pop_back();
    if (!layout.velocities)
        add_camera(r, runs[0].options().localisation, a, report);
    if (!layout.kind_radii.empty())
        add_kinds(data, layout.kind_radii, a, report);
    return report;
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
            .reset_postprocessing_keys = reset_postprocessing_keys,
            .report = report,
            .values = value_infos,
            .files = files,
            .series = series};
}

} // namespace rodwake::app::measures
