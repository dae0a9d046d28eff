#include "check_measure.hpp"

#include "measure_plan.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::cli {

namespace {

void add(std::vector<CheckLine>& lines, bool wanted, const std::string& what, const std::string& how) {
    lines.push_back(
        {wanted, wanted ? "measure " + what + ": " + how : "measure " + what + ": not named in [measure]"});
}

std::string times_text(const scene::Scene& scene, const MeasurePlan& plan) {
    const double duration = scene.granular->duration - plan.keys.from;
    return fmt::format("{:.0f} frames {:g} s apart from t = {:g} s on, in blocks of {:g} s",
                       std::floor(duration / plan.interval) + 1.0, plan.interval, plan.keys.from,
                       scene.measure->block);
}

std::string order_text(const MeasurePlan& plan) {
    const measure::StructureKeys& keys = *plan.keys.structure;
    const std::string rule =
        keys.neighbours == measure::Neighbours::delaunay ? "Delaunay neighbours"
        : keys.cutoff ? fmt::format("neighbours within {:.3g} a", *keys.cutoff / plan.layout.bead_radius)
                      : "neighbours within the first minimum of g(r)";
    return fmt::format("g(r), psi6 and g_B(r), {}, every {:g} s", rule,
                       plan.interval * static_cast<double>(plan.keys.structure_every));
}

} // namespace

std::vector<CheckLine> check_measure(const scene::Scene& scene, const granular::GranularProblem& problem) {
    if (!scene.measure)
        return {{false, "measures: no [measure] table"}};
    const scene::Measure& m = *scene.measure;
    std::vector<CheckLine> lines;
    const auto plan = measure_plan(scene, problem);
    if (plan)
        lines.push_back({true, "measured: " + times_text(scene, *plan)});
    if (!m.trajectory.empty())
        lines.push_back({true, "measured in " + m.trajectory + " instead of a granular run of this scene"});
    add(lines, m.order, "order", plan && plan->keys.structure ? order_text(*plan) : "");
    add(lines, m.microrheology, "microrheology", "mean-square displacement and stiffness of the beads");
    add(lines, m.flow, "flow", fmt::format("bead velocity over {:g} s around rod {}", m.flow_lag, m.rod));
    const bool wake = m.displacement != scene::DisplacementMethod::none;
    add(lines, wake, "displacement",
        wake ? fmt::format("field around rod {} by {}", m.rod,
                           measure::to_string(plan->keys.displacement->method))
             : "");
    add(lines, m.pairs, "pairs", "separation over half the box, who turned, outcome");
    add(lines, m.force, "force", fmt::format("momentum that rod {} hands to the beads", m.rod));
    return lines;
}

} // namespace rodwake::cli
