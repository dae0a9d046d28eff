// What the results of a stage depend on.

#include "rodwake/app/run_folder.hpp"
#include "rodwake/app/scan.hpp"
#include "rodwake/scene/write.hpp"

#include <algorithm>

namespace rodwake::app {

namespace {

/// Beds as they are, whatever they are called in legends and whatever else the variants change.
std::string beds_key(const scene::Scene& scene, Stage stage) {
    std::string text;
    for (const Case& one : bed_cases(scene)) {
        scene::Scene key;
        key.granular = one.scene.granular;
        if (key.granular) {
            key.granular->output.checkpoint = scene::GranularOutput{}.checkpoint;
            key.granular->runs = std::min(key.granular->runs, 2L); // an ensemble may grow
            if (stage == Stage::measure)
                key.measure = one.scene.measure;
            if (stage == Stage::order)
                key.rods_order = one.scene.rods_order;
            if (stage == Stage::order && one.scene.measure)
                key.measure.emplace().trajectory = one.scene.measure->trajectory;
        }
        text += "# " + one.name + "\n" + scene::to_plain_toml(key);
    }
    return text;
}

std::string theory_key(const scene::Scene& scene, Stage stage) {
    scene::Scene key;
    key.units = scene.units;
    key.scales = scene.scales;
    key.medium = scene.medium;
    if (stage == Stage::field) {
        key.field = scene.field;
        return scene::to_plain_toml(key);
    }
    key.coupling = scene.coupling;
    key.noise = scene.noise;
    key.rods_random = scene.rods_random;
    key.rods = scene.rods;
    key.rods_run = scene.rods_run;
    if (key.rods_run)
        key.rods_run->max_steps = scene::RodsRun{}.max_steps; // a limit, raised when it was met
    if (stage == Stage::order)
        key.rods_order = scene.rods_order;
    key.variants = scene.variants;
    return scene::to_plain_toml(key);
}

/// What the settings choose counts for nothing.
std::string tradeoff_key(scene::Scene scene) {
    if (!scene.rods_run)
        return theory_key(scene, Stage::rods);
    scene.rods_run->method.reset();
    scene.variants.clear();
    if (scene.medium && scene.medium->field != scene::FieldBackend::measured) {
        scene.medium->field = scene::FieldBackend::exact;
        scene.medium->table.reset();
    }
    const scene::RodsRun any;
    scene::RodsRun& run = *scene.rods_run;
    run.form = any.form;
    run.rtol = any.rtol;
    run.atol = any.atol;
    run.precision = any.precision;
    run.turning_tolerance = any.turning_tolerance;
    return scene.scan ? scan_key(scene) : theory_key(scene, Stage::rods);
}

} // namespace

std::string stage_key(const scene::Scene& scene, Stage stage) {
    switch (stage) {
    case Stage::granular:
    case Stage::measure:
        return beds_key(scene, stage);
    case Stage::order:
        return order_of_bed(scene) ? beds_key(scene, stage) : theory_key(scene, stage);
    case Stage::fit: {
        scene::Scene key;
        key.fit = scene.fit;
        return scene::to_plain_toml(key);
    }
    case Stage::scan:
        return scan_key(scene);
    case Stage::tradeoff:
        return tradeoff_key(scene);
    case Stage::field:
    case Stage::rods:
        break;
    }
    return theory_key(scene, stage);
}

} // namespace rodwake::app
