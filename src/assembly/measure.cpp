#include "rodwake/assembly/measure.hpp"

#include "rodwake/assembly/granular.hpp"
#include "rodwake/assembly/measure_kind.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/write.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::assembly {

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
    key.measure->interval = plan.interval;
    for (const MeasureKind& kind : measure_kinds())
        if (kind.reset_late_keys)
            kind.reset_late_keys(*key.measure);
    const measure::Layout& layout = plan.sums.layout();
    const std::string second = layout.box.square() ? "" : fmt::format(" x {:.17g}", layout.box.y);
    return fmt::format("{}box {:.17g}{}, beads {}, rods {}\n", scene::to_plain_toml(key), layout.box.x,
                       second, layout.beads, layout.rods);
}

} // namespace

measure::Layout layout_of(const granular::GranularProblem& p) {
    measure::Layout layout{p.box, p.bead_radius, granular::bead_mass(p), p.beads, p.rods.size()};
    for (const granular::RodSpec& rod : p.rods)
        layout.headings.push_back(rod.heading);
    return layout;
}

std::int64_t steps_between_frames(const Scene& scene) {
    const Granular& bed = *scene.granular;
    return granular::whole_steps(scene.measure->interval.value_or(frame_interval(bed)), scene::time_step(bed),
                                 1);
}

std::optional<MeasurePlan> measure_plan(const scene::Scene& scene, const granular::GranularProblem& problem) {
    const auto needs_frames = [&](const MeasureKind& kind) {
        return kind.include && kind.wanted(*scene.measure);
    };
    if (!scene.measure || !scene.granular || std::ranges::none_of(measure_kinds(), needs_frames))
        return std::nullopt;
    try { // says now what cannot be measured
        MeasurePlan plan{measure::Measures(layout_of(problem), scene.measure->from), 0.0, 1, {}};
        plan.every = steps_between_frames(scene);
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

} // namespace rodwake::assembly
