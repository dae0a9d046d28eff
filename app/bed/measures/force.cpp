// Mean force of the rod on the beads along its heading, its thrust and its speed; each run has its own in
// summary.json.

#include "rodwake/measure/statistics.hpp"

#include "bed/measure_parts.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::app::measures {

namespace {

using scene::Measure, scene::Scene;

constexpr SeriesInfo series[] = {{{"force", "N", "of the rod on the beads along its heading"}},
                                 {{"speed", "a/s", "of the rod along its heading"}},
                                 {{"thrust", "N", "of the plates on the rod along its heading"}}};

Estimate of_rod(const MeasuredCase& data, const char* name) {
    return measure::mean_of_blocks(
        of_summaries(data, fmt::format("rods.{}.{}", data.scene.measure->rod, name), "rod with its force"));
}

struct ForceValues {
    Estimate force, thrust, speed;
};
using F = const ForceValues&;

constexpr ResultValue<ForceValues> values[] = {
    {{"force", "Force", "\u00b5N", "of the rod on the beads, along its heading", 1e6},
     [](F f) { return f.force; }},
    {{"thrust", "Thrust", "\u00b5N", "of the plates on the rod, along its heading", 1e6},
     [](F f) { return f.thrust; }},
    {{"speed", "Speed", "a/s", "of the rod along its heading"}, [](F f) { return f.speed; }},
};
constexpr auto value_infos = infos_of(values);

MeasureReport report(const MeasuredCase& data) {
    const ForceValues f = {of_rod(data, "force"), of_rod(data, "thrust"),
                           of_rod(data, "mean_speed").scaled(1.0 / data.bead_radius())};
    return {.values = values_of(values, f),
            .line = fmt::format("force on the beads {} uN, thrust {} uN, at {} a/s",
                                text(f.force.scaled(1e6)), text(f.thrust.scaled(1e6)), text(f.speed))};
}

// Force against the imposed speeds of several cases.

void add_line(Values& out, const std::string& name, const measure::LineFit& fit) {
    const std::string table = "force_against_imposed_speed." + name + ".";
    out.push_back({table + "intercept_N.value", fit.intercept.value});
    out.push_back({table + "intercept_N.error", fit.intercept.error});
    out.push_back({table + "slope_N_s_per_m.value", fit.slope.value});
    out.push_back({table + "slope_N_s_per_m.error", fit.slope.error});
    out.push_back({table + "chi2", fit.chi2});
    out.push_back({table + "dof", fit.dof});
    out.push_back({table + "probability", measure::chi2_probability(fit.chi2, fit.dof)});
}

/// f = f0 + c v and f = c v; nothing without three imposed speeds with errors.
Values force_lines(std::span<const SeriesRow> rows) {
    std::vector<double> v, f, error;
    for (const SeriesRow& row : rows) {
        const auto force = std::ranges::find(row.values, "force", &SeriesValue::name);
        if (!row.imposed_speed || force == row.values.end() || !(force->value.error > 0.0))
            continue;
        v.push_back(*row.imposed_speed);
        f.push_back(force->value.value);
        error.push_back(force->value.error);
    }
    Values out;
    if (v.size() < 3 || std::ranges::count(v, v[0]) == static_cast<long>(v.size()))
        return out;
    add_line(out, "line", measure::fit_line(v, f, error));
    add_line(out, "proportional", measure::fit_proportional(v, f, error));
    return out;
}

} // namespace

MeasureKind force() {
    return {.name = "force",
            .order = 60,
            .wanted = [](const Measure& m) { return m.force; },
            .describe =
                [](const Scene& scene) {
                    return fmt::format("momentum that rod {} hands to the beads", scene.measure->rod);
                },
            .reset_postprocessing_keys = [](Measure& m) { m.force = false; },
            .report = report,
            .compare = force_lines,
            .values = value_infos,
            .series = series};
}

} // namespace rodwake::app::measures
