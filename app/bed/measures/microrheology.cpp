// Mean-square displacement of the beads, the stiffness of what holds them and its memory.

#include "rodwake/measure/microrheology.hpp"
#include "rodwake/measure/memory_kernel.hpp"

#include "bed/measure_parts.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

namespace rodwake::app::measures {

namespace {

using measure::MemoryKernel, measure::MicrorheologyAccumulator, measure::MicrorheologyResult,
    measure::StiffnessSpectrum;
using scene::Measure, scene::Scene;

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

struct ScaledMicrorheology : MicrorheologyResult {
    MemoryKernel memory;
    std::optional<Estimate> drag;
    double a; ///< m
    double area = 1.0 / (a * a);
};

struct MicrorheologyValues : ScaledMicrorheology {
    static constexpr auto fields() {
        using R = MicrorheologyValues;
        return std::tuple{
            field("stiffness", {"Stiffness"}, {"a^-2", R"($1/(s \tilde{\Delta}(s))$ for $s \to 0$)"},
                  [](const R& r) { return r.stiffness_zero.scaled(r.a * r.a); }),
            field("scatter", {"a^-2", "part of the error of the stiffness: from noise"},
                  [](const R& r) { return r.scatter * r.a * r.a; }),
            field("bend",
                  {"a^-2", "part of the error of the stiffness: from the bend of the curve in the window"},
                  [](const R& r) { return r.bend * r.a * r.a; }),
            field("spring", {"Spring constant", "\u00b5N/m"},
                  {"N/m", "of what holds a bead: $4mT_{xy}$ times the stiffness"}, &R::spring),
            field("s_low", {"Extrapolated from"}, {"1/s", "lowest $s$ used"}, &R::s_low),
            field("s_high", {"Extrapolated to"}, {"1/s", "highest $s$ used"}, &R::s_high),
            field("window_narrowed", &R::window_narrowed,
                  {"1", "whether there were too few lags for the wanted window"}),
            field("temperature", {"$T_{xy}$"}, {"m^2/s^2", "of the measured frames"},
                  [](const R& r) { return r.spring.count > 0 ? r.temperature : std::nan(""); }),
            field("frames", &R::frames, {"1", "measured"}),
            field("kernel_low", {"Memory kernel from"},
                  {"1/s", "lowest $s$ at which the run is long enough for 2 %"},
                  [](const R& r) { return r.spectrum.low.value_or(std::nan("")); }),
            field("kernel_high", {"Memory kernel to"},
                  {"1/s", "highest $s$ at which frames are close enough for 2 %"},
                  [](const R& r) { return r.spectrum.high.value_or(std::nan("")); }),
            field("inertia_share", {"Inertia at that $s$"},
                  {"1", "$ms^2$ over $4mT_{xy}/(s\\tilde{\\Delta})$"},
                  [](const R& r) {
                      // The share of the inertia, which was subtracted, in the resistance at the upper end of
                      // the range.
                      if (!r.spectrum.high || r.memory.s.empty())
                          return std::nan("");
                      const auto at = std::ranges::find(r.memory.s, *r.spectrum.high) - r.memory.s.begin();
                      return 1.0 - r.memory.with_drag[at] / r.memory.total[at];
                  }),
            field("bead_drag", {"Drag on a bead"},
                  {"1/s", "$\\Gamma/m$ as given, which the kernel is without"},
                  [](const R& r) -> std::variant<std::monostate, Estimate> {
                      if (r.drag)
                          return *r.drag;
                      return {};
                  })};
    }
};

struct MeanSquareDisplacement : ScaledMicrorheology {
    static constexpr auto fields() {
        using R = MeanSquareDisplacement;
        return std::tuple{field("lag", &R::lag, {"s", "time between two positions of a bead"}),
                          field("msd", {"a^2", "mean-square displacement, drift removed"},
                                [](const R& r) { return scaled(r.msd, r.area); }),
                          field("sigma", {"a^2", "standard error (empty: unknown)"},
                                [](const R& r) { return scaled(r.msd_error, r.area); }),
                          field("origins", &R::origins, {"1", "starting times behind the value"})};
    }
};

struct StiffnessColumns : ScaledMicrorheology {
    static constexpr auto fields() {
        using R = StiffnessColumns;
        return std::tuple{field("s", &R::s, {"1/s", "Laplace frequency"}),
                          field("value", {"1/a^2", "1/(s MSD~(s))"},
                                [](const R& r) { return scaled(r.stiffness, r.a * r.a); }),
                          field("sigma", {"1/a^2", "standard error (empty: unknown)"},
                                [](const R& r) { return scaled(r.stiffness_error, r.a * r.a); })};
    }
};

/// A row of msd_kinds.csv.
struct KindDisplacement {
    std::size_t kind;
    double lag, msd, error; ///< s, a^2

    static constexpr auto fields() {
        using R = KindDisplacement;
        return std::tuple{
            field("kind", &R::kind, {"1", "number in bead_kinds, from 0"}),
            field("lag", &R::lag, {"s", "time between two positions of a bead"}),
            field("msd", &R::msd, {"a^2", "mean-square displacement, drift of all beads removed"}),
            field("sigma", &R::error, {"a^2", "standard error (empty: unknown)"})};
    }
};

/// A row of stiffness_kinds.csv.
struct KindStiffness {
    std::size_t kind;
    double radius, stiffness, error; ///< a, 1/a^2

    static constexpr auto fields() {
        using R = KindStiffness;
        return std::tuple{field("kind", &R::kind, {"1", "number in bead_kinds, from 0"}),
                          field("radius", &R::radius, {"a", "of its beads, mean"}),
                          field("stiffness", &R::stiffness, {"1/a^2", "1/(s MSD~(s)) at s -> 0"}),
                          field("sigma", &R::error, {"1/a^2", "standard error (empty: unknown)"})};
    }
};

/// Only tracks have these; the stage logs them.
struct LocalisationValues {
    std::variant<std::monostate, Estimate> localisation;
    double taken_off;
    std::optional<std::string> no_stiffness;

    static constexpr auto fields() {
        using R = LocalisationValues;
        return std::tuple{
            field(
                "localisation", &R::localisation,
                {"a",
                 "of tracks: standard error of a coordinate, as the first lags of the displacement have it"}),
            field("taken_off", &R::taken_off,
                  {"a^2", "of tracks: taken off the mean-square displacement at every lag, for that error"}),
            field("no_stiffness", &R::no_stiffness, {"", "why there is none"})};
    }
};

void add_camera(const MicrorheologyResult& r, const Localisation& asked, double a, MeasureReport& report) {
    const bool is_known = r.localisation.has_value();
    const Estimate found = r.localisation.value_or(Estimate{}).scaled(1.0 / a);
    LocalisationValues values = {{}, r.taken_off / (a * a), {}};
    if (is_known)
        values.localisation = found;
    if (!r.no_stiffness.empty()) {
        values.no_stiffness = r.no_stiffness;
        report.line = "mean-square displacement; no stiffness: " + r.no_stiffness;
    }
    report.values.update(record_json(values));
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
    std::vector<KindStiffness> stiffness;
    std::vector<KindDisplacement> msd;
    for (std::size_t k = 0; k < radii.size(); ++k) {
        const auto runs = measure::take<MicrorheologyAccumulator>(data.sums, kind_name(k));
        try {
            const MicrorheologyResult r = measure::reduce(runs);
            const Estimate of_kind = r.stiffness_zero.scaled(a * a);
            for (std::size_t i = 0; i < r.lag.size(); ++i)
                msd.push_back({k, r.lag[i], r.msd[i] / (a * a), r.msd_error[i] / (a * a)});
            if (!r.no_stiffness.empty())
                throw InputError(r.no_stiffness);
            stiffness.push_back({k, radii[k] / a, of_kind.value, of_kind.error});
            report.line += fmt::format("; of kind {} {} /a^2", k, text(of_kind));
        } catch (const InputError& error) {
            report.line += fmt::format("; of kind {} no stiffness: {}", k, error.what());
        }
    }
    report.tables.push_back(
        {"msd_kinds.csv", "mean-square displacement by kinds of beads; lag in s, msd in a^2", csv_of(msd)});
    report.tables.push_back(
        {"stiffness_kinds.csv", "1/(s MSD~(s)) at s -> 0 by kinds of beads, in 1/a^2", csv_of(stiffness)});
}

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius();
    const auto runs = measure::take<MicrorheologyAccumulator>(data.sums, "microrheology");
    MicrorheologyResult r = measure::reduce(runs);
    if (!data.tables.empty() && r.spring.count > 0)
        r.use_temperature(mean_of(of_summaries(data, "T_xy", "T_xy")).value);
    const Estimate stiffness = r.stiffness_zero.scaled(a * a);
    const Measure& m = *data.scene.measure;
    std::optional<Estimate> drag;
    if (m.bead_drag)
        drag = Estimate{*m.bead_drag, m.bead_drag_error.value_or(unknown_error), 1};
    const measure::Layout& layout = runs[0].layout();
    const bool warm = layout.velocities && layout.kind_radii.empty(); // else nothing is known of forces
    const MemoryKernel kernel =
        warm ? measure::memory_kernel(r.spectrum, layout.bead_mass, r.temperature, drag) : MemoryKernel{};
    const ScaledMicrorheology f = {r, kernel, drag, a};
    std::string line = fmt::format("stiffness {} /a^2", text(stiffness));
    if (r.spring.count > 0)
        line += fmt::format(", spring {} N/m, ", text(r.spring)) +
                (r.spectrum.low ? fmt::format("{} from s = {:.3g} to {:.3g} 1/s",
                                              drag ? "memory kernel" : "kernel with drag", *r.spectrum.low,
                                              *r.spectrum.high)
                                : "memory kernel at no s within 2 %");
    data.row.stiffness = stiffness;
    MeasureReport report = {
        .values = record_json(MicrorheologyValues{f}),
        .tables = {{"msd.csv", "mean-square displacement, drift removed; lag in s, msd in a^2",
                    csv_of(MeanSquareDisplacement{f})},
                   {"stiffness.csv", "1/(s MSD~(s)) in 1/a^2; s in 1/s", csv_of(StiffnessColumns{f})},
                   {"memory_kernel.csv", "memory kernel of what holds a bead in N/m against s in 1/s",
                    csv_of(kernel)}},
        .line = std::move(line)};
    if (!warm)
        report.tables.pop_back();
    if (!layout.velocities)
        add_camera(r, runs[0].options().localisation, a, report);
    if (!layout.kind_radii.empty())
        add_kinds(data, layout.kind_radii, a, report);
    return report;
}

std::vector<FileKind> files() {
    return {
        {"msd.csv", Lifetime::result, "mean-square displacement of the beads",
         columns_of<MeanSquareDisplacement>()},
        {"stiffness.csv", Lifetime::result, "stiffness from microrheology", columns_of<StiffnessColumns>()},
        {"memory_kernel.csv", Lifetime::result, "memory kernel from microrheology",
         columns_of<MemoryKernel>()},
        {"msd_kinds.csv", Lifetime::result,
         "mean-square displacement of beads of several sizes, by their kinds",
         columns_of<KindDisplacement>()},
        {"stiffness_kinds.csv", Lifetime::result, "stiffness of beads of several sizes, by their kinds",
         columns_of<KindStiffness>()}};
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
            .values = values_of<MicrorheologyValues, true>,
            .film_numbers = values_of<LocalisationValues>,
            .files = files};
}

} // namespace rodwake::app::measures
