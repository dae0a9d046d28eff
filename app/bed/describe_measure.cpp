#include "rodwake/app/measure_kind.hpp"
#include "run/describe_parts.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::app {

namespace {

std::string times_text(const scene::Scene& scene, const MeasurePlan& plan) {
    const double duration = scene.granular->duration - plan.sums.from();
    const std::string travel = plan.sums.from_travel() > 0.0
                                   ? fmt::format(" and once rod {} has come {:.4g} a", scene.measure->rod,
                                                 plan.sums.from_travel() / scene.granular->bead_radius)
                                   : "";
    return fmt::format("{:.0f} frames {:g} s apart from t = {:g} s on{}, in blocks of {:g} s",
                       std::floor(duration / plan.interval) + 1.0, plan.interval, plan.sums.from(), travel,
                       scene.measure->block);
}

} // namespace

void describe_measures(const BedPlan& bed, Lines& lines) {
    const scene::Scene& scene = bed.of.scene;
    if (!scene.measure) {
        lines.push_back({false, "measures: no [measure] table"});
        return;
    }
    const auto& plan = bed.measures;
    const scene::Measure& m = *scene.measure;
    if (plan)
        lines.push_back({true, "measured: " + times_text(scene, *plan)});
    if (!m.trajectory.empty())
        lines.push_back({true, "measured in " + m.trajectory + " instead of a granular run of this scene"});
    for (const MeasureKind& kind : measure_kinds()) {
        const bool wanted = kind.wanted(m);
        lines.push_back({wanted, fmt::format("measure {}: {}", kind.name,
                                             wanted ? kind.describe(scene) : "not named in [measure]")});
    }
}

} // namespace rodwake::app
