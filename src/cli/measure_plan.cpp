#include "measure_plan.hpp"

#include "granular_problem.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/write.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::cli {

namespace {

using scene::Granular;
using scene::Measure;

measure::Layout layout_of(const granular::GranularProblem& p) {
    const double a = p.bead_radius;
    return {p.box, a, 4.0 / 3.0 * std::numbers::pi * a * a * a * p.bead_density, p.beads, p.rods.size()};
}

measure::StructureKeys structure_keys(const Measure& m, double a) {
    measure::StructureKeys keys;
    keys.neighbours = m.order_neighbours == scene::NeighbourRule::delaunay ? measure::Neighbours::delaunay
                                                                           : measure::Neighbours::cutoff;
    keys.cutoff = m.order_cutoff;
    keys.bin = 0.05 * a;
    keys.order_bin = a;
    keys.block = m.block;
    return keys;
}

measure::DisplacementMethod method_of(scene::DisplacementMethod method) {
    switch (method) {
    case scene::DisplacementMethod::lagrangian:
        return measure::DisplacementMethod::lagrangian;
    case scene::DisplacementMethod::density:
        return measure::DisplacementMethod::density;
    default:
        return measure::DisplacementMethod::phase;
    }
}

measure::DisplacementKeys displacement_keys(const Measure& m, double a) {
    measure::DisplacementKeys keys;
    keys.method = method_of(m.displacement);
    keys.reference =
        m.reference == scene::DisplacementReference::box ? measure::Reference::box : measure::Reference::far;
    keys.rod = static_cast<std::size_t>(m.rod);
    keys.spacing = m.spacing.value_or(a);
    keys.far_from = m.far_from.value_or(0.0);
    keys.block = m.block;
    keys.mirror = m.mirror;
    return keys;
}

measure::FlowKeys flow_keys(const Measure& m, double a) {
    measure::FlowKeys keys;
    keys.rod = static_cast<std::size_t>(m.rod);
    keys.spacing = m.flow_spacing.value_or(2.0 * a);
    keys.lag = m.flow_lag;
    keys.block = m.block;
    keys.marked_within = m.marked_within.value_or(6.0 * a);
    keys.marked_travel = m.marked_travel.value_or(0.0);
    return keys;
}

/// Order is measured every so many of the measured frames.
std::size_t order_stride(const Measure& m, double interval) {
    const double wanted = m.order_interval.value_or(std::max(interval, 0.5));
    return static_cast<std::size_t>(std::max(1.0, std::ceil(wanted / interval * (1.0 - 1e-9))));
}

/// The table without what is worked out from other files, or only when the runs are put together.
std::string key_text(const Measure& m, const MeasurePlan& plan) {
    scene::Scene key;
    key.granular.emplace();
    key.measure = m;
    Measure& kept = *key.measure;
    const Measure unset;
    kept.pairs = kept.force = false;
    kept.trajectory = unset.trajectory;
    kept.profile_offset = unset.profile_offset;
    kept.contact_distance = unset.contact_distance;
    kept.reference = unset.reference;
    kept.mirror = unset.mirror;
    kept.s_low = kept.s_high = std::nullopt;
    kept.interval = plan.interval;
    return fmt::format("{}box {:.17g}, beads {}, rods {}\n", scene::to_plain_toml(key), plan.layout.box,
                       plan.layout.beads, plan.layout.rods);
}

} // namespace

std::optional<MeasurePlan> measure_plan(const scene::Scene& scene, const granular::GranularProblem& problem) {
    if (!scene.measure || !scene.granular)
        return std::nullopt;
    const Measure& m = *scene.measure;
    const Granular& bed = *scene.granular;
    MeasurePlan plan;
    plan.layout = layout_of(problem);
    plan.every = whole_steps(m.interval.value_or(frame_interval(bed)), bed.time_step, 1);
    plan.interval = static_cast<double>(plan.every) * bed.time_step;
    const double a = bed.bead_radius;
    if (m.order)
        plan.keys.structure = structure_keys(m, a);
    if (m.microrheology)
        plan.keys.microrheology = measure::MicrorheologyKeys{0.0, m.s_low, m.s_high};
    if (m.flow)
        plan.keys.flow = flow_keys(m, a);
    if (m.displacement != scene::DisplacementMethod::none)
        plan.keys.displacement = displacement_keys(m, a);
    plan.keys.from = m.from;
    plan.keys.structure_every = order_stride(m, plan.interval);
    if (!plan.keys.any())
        return std::nullopt;
    plan.key_text = key_text(m, plan);
    try {
        measure::Measures(plan.layout, plan.keys); // says now what cannot be measured
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", scene.path, error.what()));
    }
    return plan;
}

double profile_offset(const scene::Scene& scene) {
    return scene.measure->profile_offset.value_or(4.0 * scene.granular->bead_radius);
}

double contact_distance(const scene::Scene& scene) {
    double longest = 0.0;
    for (const scene::GranularRod& rod : scene.granular->rods)
        longest = std::max(longest, rod.length);
    return scene.measure->contact_distance.value_or(0.5 * longest);
}

} // namespace rodwake::cli
