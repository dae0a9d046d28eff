// What a scan depends on: the part of the scene that its points are made from.

#include "rodwake/app/scan_problem.hpp"
#include "rodwake/core/encounter.hpp"
#include "rodwake/scene/write.hpp"
#include "run/record_table.hpp"
#include "scan_parts.hpp"
#include "scan_values.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::app {

namespace {

/// Design and axes as far as they decide what a point of some number is.
scene::Scan scan_keys(const scene::Scan& scan) {
    scene::Scan key;
    key.design = scan.design;
    key.axes = scan.axes;
    for (scene::ScanAxis& axis : key.axes)
        axis.label.clear();
    if (scan.design == scene::ScanDesign::lhs) { // another number of slices is another sample
        key.samples = scan.samples;
        key.seed = scan.seed;
    }
    return key;
}

/// A bed, and when two of its rods touch.
scene::Scene bed_keys(const scene::Scene& scene) {
    scene::Scene key;
    key.path = scene.path;
    key.granular = scene.granular;
    if (scene.measure && scene.measure->contact_distance)
        key.measure.emplace().contact_distance = scene.measure->contact_distance;
    return key;
}

} // namespace

void leave_out_outputs(std::optional<scene::RodsRun>& run) {
    if (!run)
        return;
    run->output_times = {run->t_end};
    run->t_end_from_outputs = false;
}

scene::Scene scan_base(const scene::Scene& scene) {
    if (scan_subject(scene) == scene::ScanSubject::beds)
        return bed_keys(scene);
    scene::Scene base = scene;
    base.scan.reset();
    base.field.reset();
    base.granular.reset();
    base.figures.clear();
    leave_out_outputs(base.rods_run);
    return base;
}

scan::Columns columns_of_rods(const scene::Scene& scene) {
    scan::Columns columns;
    for (const Ending ending : all_endings)
        columns.outcomes.emplace_back(rodwake::to_string(ending));
    EncounterEnd some;
    some.turn.resize(scene.rods.size());
    for_each_number(some, told_turns, [&](const auto& field, int rod, double) {
        columns.observables.push_back(numbered(field.name, rod));
    });
    if (scene.noise)
        for (const std::string_view name : field_names<CaptureNumbers>())
            columns.observables.emplace_back(name);
    return columns;
}

std::string scan_key(const scene::Scene& scene) {
    const bool beds = scan_subject(scene) == scene::ScanSubject::beds;
    scene::Scene key = beds ? bed_keys(scene) : scene;
    key.title.clear();
    key.field.reset();
    key.figures.clear();
    key.fit.reset();
    if (beds) {
        key.granular->runs = 1; // more of them go on with those there are
        key.granular->output.checkpoint = scene::GranularOutput{}.checkpoint;
    } else {
        key.granular.reset();
        key.measure.reset();
    }
    leave_out_outputs(key.rods_run);
    if (key.rods_run)
        key.rods_run->max_steps = scene::RodsRun{}.max_steps; // a limit, raised when it was met
    if (scene.scan)
        key.scan = scan_keys(*scene.scan);
    return scene::to_plain_toml(key);
}

} // namespace rodwake::app
