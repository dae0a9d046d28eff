#include "rodwake/app/measure.hpp"

#include "bed/measure_kind.hpp"
#include "rodwake/app/granular.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "run/describe_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

using scene::Granular;
using scene::Measure;
using scene::Scene;

/// The table without what is worked out from other files, or only when the runs are put together.
std::string key_text(const Measure& m, const MeasurePlan& plan) {
    scene::Scene key;
    key.granular.emplace();
    key.measure = m;
    key.measure->trajectory.clear();
    key.measure->interval = plan.interval * static_cast<double>(plan.stride);
    key.measure->phonon_interval = m.phonons ? std::optional(plan.interval) : std::nullopt; // as it was taken
    for (const MeasureKind& kind : measure_kinds())
        if (kind.reset_postprocessing_keys)
            kind.reset_postprocessing_keys(*key.measure);
    const measure::Layout& layout = plan.sums.layout();
    const std::string second = layout.box.square() ? "" : fmt::format(" x {:.17g}", layout.box.y);
    std::string kinds;
    for (const double radius : layout.kind_radii)
        kinds += fmt::format(", beads of radius {:.17g}", radius);
    std::string force;
    if (const auto& f = layout.force; f && m.displacement)
        force = fmt::format("force at {:.17g}, {:.17g}, goes at {:.17g}, {:.17g}, points to {:.17g}\n", f->x,
                            f->y, f->vx, f->vy, f->heading);
    return fmt::format("{}box {:.17g}{}, beads {}, rods {}{}\n{}", scene::to_plain_toml(key), layout.box.x,
                       second, layout.beads, layout.rods, kinds, force);
}

/// Steps between the frames of currents: the largest part of `steps` that takes at most 5 ms, or what the
/// scene says.
std::int64_t steps_between_currents(const Scene& scene, std::int64_t steps) {
    constexpr double longest = 5e-3; // s: a twentieth of the fastest mode's period in a box of 78 a
    const double step = scene::time_step(*scene.granular);
    if (const auto& wanted = scene.measure->phonon_interval) {
        const std::int64_t fine = granular::whole_steps(*wanted, step, 1);
        if (steps % fine != 0)
            throw InputError(fmt::format("measure.phonon_interval = {:g} s: in time steps of {:g} s the "
                                         "interval of {} steps is no whole multiple of its {} steps",
                                         *wanted, step, steps, fine));
        return fine;
    }
    const auto too_long = [&](std::int64_t fine) {
        return static_cast<double>(fine) * step > longest * (1.0 + 1e-6);
    };
    std::int64_t parts = 1;
    while (parts < steps && (steps % parts != 0 || too_long(steps / parts)))
        ++parts;
    return steps / parts;
}

measure::Measures no_sums(const Scene& scene, const measure::Layout& layout) {
    const Measure& m = *scene.measure;
    return {layout, m.from, {static_cast<std::size_t>(m.rod), m.from_travel.value_or(0.0)}};
}

} // namespace

measure::Layout layout_of(const granular::GranularProblem& p) {
    measure::Layout layout{granular::bed_sides(p), p.bead_radius, granular::mean_bead_mass(p), p.beads,
                           p.rods.size()};
    if (p.container) // where the centres of beads may be
        layout.window = measure::room_within(p.container->kind == granular::ContainerKind::circle,
                                             p.container->sides, granular::bead_mix(p).smallest());
    for (const granular::RodSpec& rod : p.rods)
        layout.headings.push_back(rod.heading);
    // The displacement of a bed without rods is seen from its force.
    if (p.rods.empty() && p.body_force && p.body_force->kind == granular::BodyForceKind::gaussian) {
        const granular::BodyForce& force = *p.body_force;
        const double c = std::cos(force.direction), s = std::sin(force.direction);
        const bool middle = force.place.empty();
        layout.force = measure::MovingForce{middle ? 0.5 * p.box.x : force.place[0],
                                            middle ? 0.5 * p.box.y : force.place[1], force.speed * c,
                                            force.speed * s, force.direction};
    }
    if (!granular::bead_mix(p).one_size())
        for (const granular::BeadKind& kind : p.bead_kinds)
            layout.kind_radii.push_back(kind.radius);
    return layout;
}

std::int64_t steps_between_frames(const Scene& scene) {
    const Granular& bed = *scene.granular;
    return granular::whole_steps(scene.measure->interval.value_or(frame_interval(bed)), scene::time_step(bed),
                                 1);
}

double measured_interval(const Scene& scene) {
    if (!scene.tracks)
        return static_cast<double>(steps_between_frames(scene)) * scene::time_step(*scene.granular);
    const auto& rate = scene.tracks->frames_per_second;
    return scene.measure->interval.value_or(rate ? 1.0 / *rate : 0.0);
}

double measured_duration(const Scene& scene, std::optional<double> film) {
    return (scene.tracks ? film.value_or(HUGE_VAL) : scene.granular->duration) - scene.measure->from;
}

std::optional<MeasurePlan> measure_plan(const scene::Scene& scene, const granular::GranularProblem& problem) {
    const auto needs_frames = [&](const MeasureKind& kind) {
        return kind.include && kind.wanted(*scene.measure);
    };
    if (!scene.measure || !scene.granular || std::ranges::none_of(measure_kinds(), needs_frames))
        return std::nullopt;
    try { // says now what cannot be measured
        MeasurePlan plan{no_sums(scene, layout_of(problem)), 0.0, 1, 1, {}};
        plan.mix = granular::bead_mix(problem);
        const bool drawn = scene.granular->start == scene::GranularStart::lattice ||
                           scene.granular->start == scene::GranularStart::random;
        if (drawn && plan.mix->spread == 0.0 && !plan.mix->kinds.empty()) {
            plan.kind_counts.resize(plan.mix->kinds.size());
            const std::vector<std::size_t> counts = granular::kind_counts(problem);
            for (std::size_t k = 0; k < counts.size(); ++k)
                plan.kind_counts[plan.mix->nearest(plan.mix->kinds[k].radius)] += counts[k];
        }
        const std::int64_t steps = steps_between_frames(scene);
        plan.every = scene.measure->phonons ? steps_between_currents(scene, steps) : steps;
        plan.stride = static_cast<std::size_t>(steps / plan.every);
        plan.interval = static_cast<double>(plan.every) * problem.time_step;
        for (const MeasureKind& kind : measure_kinds())
            if (needs_frames(kind))
                kind.include(scene, plan);
        plan.key_text = key_text(*scene.measure, plan);
        return plan;
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", scene.path, error.what()));
    }
}

MeasurePlan measure_plan(const Scene& scene, const measure::Layout& layout, double interval) {
    try {
        MeasurePlan plan{no_sums(scene, layout), interval, 1, 1, {}};
        for (const MeasureKind& kind : measure_kinds())
            if (kind.include && kind.wanted(*scene.measure))
                kind.include(scene, plan);
        return plan;
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", scene.path, error.what()));
    }
}

void describe_measures(const BedPlan& bed, Lines& lines) {
    const scene::Scene& scene = bed.of.scene;
    if (!scene.measure) {
        lines.push_back({false, "measures: no [measure] table"});
        return;
    }
    const auto& plan = bed.measures;
    const scene::Measure& m = *scene.measure;
    if (plan) {
        const double duration = scene.granular->duration - plan->sums.from();
        const std::string travel = plan->sums.from_travel() > 0.0
                                       ? fmt::format(" and once rod {} has come {:.4g} a", scene.measure->rod,
                                                     plan->sums.from_travel() / scene.granular->bead_radius)
                                       : "";
        lines.push_back(
            {true, "measured: " +
                       fmt::format("{:.0f} frames {:g} s apart from t = {:g} s on{}, in blocks of {:g} s",
                                   std::floor(duration / plan->interval) + 1.0, plan->interval,
                                   plan->sums.from(), travel, scene.measure->block)});
    }
    if (!m.trajectory.empty())
        lines.push_back({true, "measured in " + m.trajectory + " instead of a granular run of this scene"});
    for (const MeasureKind& kind : measure_kinds()) {
        const bool wanted = kind.wanted(m);
        lines.push_back({wanted, fmt::format("measure {}: {}", kind.name,
                                             wanted ? kind.describe(scene) : "not named in [measure]")});
    }
}

} // namespace rodwake::app
