// Mean force of the rod on the beads along its heading, its thrust and its speed; each run has its own in
// summary.json.

#include "rodwake/measure/statistics.hpp"

#include "bed/measure_parts.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::app::measures {

namespace {

using nlohmann::ordered_json;
using scene::Measure, scene::Scene;

Estimate of_rod(const MeasuredCase& data, const char* name) {
    return measure::mean_of_blocks(
        of_summaries(data, fmt::format("rods.{}.{}", data.scene.measure->rod, name), "rod with its force"));
}

struct ForceValues {
    Estimate force, thrust, speed;

    static constexpr auto fields() {
        using R = ForceValues;
        return std::tuple{field("force", {"Force", "\u00b5N"},
                                {"N", "of the rod on the beads, along its heading"}, &R::force),
                          field("thrust", {"Thrust", "\u00b5N"},
                                {"N", "of the plates on the rod, along its heading"}, &R::thrust),
                          field("speed", {"Speed"}, {"a/s", "of the rod along its heading"}, &R::speed)};
    }
};

MeasureReport report(const MeasuredCase& data) {
    const ForceValues f = {of_rod(data, "force"), of_rod(data, "thrust"),
                           of_rod(data, "mean_speed").scaled(1.0 / data.bead_radius())};
    data.row.force = f.force;
    data.row.thrust = f.thrust;
    data.row.speed = f.speed;
    return {.values = record_json(f),
            .line = fmt::format("force on the beads {} uN, thrust {} uN, at {} a/s",
                                text(f.force.scaled(1e6)), text(f.thrust.scaled(1e6)), text(f.speed))};
}

// Force against the imposed speeds of several cases.

ordered_json line_json(const measure::LineFit& fit) {
    const auto number = [](const Estimate& e) -> ordered_json {
        return {{"value", e.value}, {"error", e.error}};
    };
    return {{"intercept_N", number(fit.intercept)},
            {"slope_N_s_per_m", number(fit.slope)},
            {"chi2", fit.chi2},
            {"dof", fit.dof},
            {"probability", measure::chi2_probability(fit.chi2, fit.dof)}};
}

/// f = f0 + c v and f = c v; nothing without three imposed speeds with errors.
ordered_json force_lines(std::span<const SeriesRow> rows) {
    ordered_json out = ordered_json::object();
    std::vector<double> v, f, error;
    for (const SeriesRow& row : rows) {
        if (!row.imposed_speed || !(row.force.error > 0.0))
            continue;
        v.push_back(*row.imposed_speed);
        f.push_back(row.force.value);
        error.push_back(row.force.error);
    }
    if (v.size() < 3 || std::ranges::count(v, v[0]) == static_cast<long>(v.size()))
        return out;
    out["force_against_imposed_speed"] = {
        {"line", line_json(measure::fit_line(v, f, error))},
        {"proportional", line_json(measure::fit_proportional(v, f, error))}};
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
            .values = values_of<ForceValues, true>};
}

} // namespace rodwake::app::measures
