#include "stage_kind.hpp"

#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rodwake::app {

const StageKind& kind_of(Stage stage) {
#define RODWAKE_KIND(name) name##_stage(),
    static const std::array kinds{RODWAKE_STAGES(RODWAKE_KIND)};
#undef RODWAKE_KIND
    return kinds[static_cast<std::size_t>(stage)];
}

const std::vector<Stage>& all_stages() {
    static const std::vector<Stage> all = [] {
        std::vector<Stage> stages(static_cast<std::size_t>(Stage::end));
        std::ranges::generate(stages, [i = 0]() mutable { return static_cast<Stage>(i++); });
        return stages;
    }();
    return all;
}

const char* to_string(Stage stage) {
#define RODWAKE_TEXT(name) #name,
    static constexpr const char* names[] = {RODWAKE_STAGES(RODWAKE_TEXT)};
#undef RODWAKE_TEXT
    return names[static_cast<std::size_t>(stage)];
}

bool has_table(const scene::Scene& scene, Stage stage) { return kind_of(stage).has_table(scene); }

std::string stage_key(const scene::Scene& scene, Stage stage) { return kind_of(stage).key(scene); }

std::vector<Stage> stages_of(const scene::Scene& scene) {
    std::vector<Stage> stages;
    std::ranges::copy_if(all_stages(), std::back_inserter(stages), [&](Stage stage) {
        const StageKind& kind = kind_of(stage);
        return kind.wanted && kind.wanted(scene);
    });
    return stages;
}

std::string key_of_beds(const scene::Scene& scene,
                        const std::function<void(scene::Scene& key, const scene::Scene& of)>& add) {
    std::string text;
    for (const Case& case_ : bed_cases(scene)) {
        scene::Scene key;
        key.granular = case_.scene.granular;
        if (key.granular) {
            key.granular->output.checkpoint = scene::GranularOutput{}.checkpoint;
            key.granular->runs = std::min(key.granular->runs, 2L); // an ensemble may grow
            if (add)
                add(key, case_.scene);
        }
        text += "# " + case_.name + "\n" + scene::to_plain_toml(key);
    }
    return text;
}

scene::Scene key_of_field(const scene::Scene& scene) {
    scene::Scene key;
    key.units = scene.units;
    key.scales = scene.scales;
    key.medium = scene.medium;
    return key;
}

scene::Scene key_of_rods(const scene::Scene& scene) {
    scene::Scene key = key_of_field(scene);
    key.coupling = scene.coupling;
    key.noise = scene.noise;
    key.rods_random = scene.rods_random;
    key.body = scene.body;
    key.rods = scene.rods;
    key.rods_run = scene.rods_run;
    if (key.rods_run)
        key.rods_run->max_steps = scene::RodsRun{}.max_steps, // a limit, raised when it was met
            key.rods_run->t_end_limit.reset();                // of scans
    key.variants = scene.variants;
    return key;
}

bool wants_more_runs(const scene::Scene& old, const scene::Scene& scene) {
    return old.granular && scene.granular && scene.granular->runs > old.granular->runs;
}

bool only_measures(const Plan& plan) {
    return std::ranges::all_of(plan.stages,
                               [](Stage stage) { return stage == Stage::measure || stage == Stage::order; });
}

void require_run(const Plan& plan, const std::filesystem::path& folder) {
    if (run_status(folder).empty())
        throw InputError(
            fmt::format("{}: holds no rodwake run; rodwake {} SCENE makes one, rodwake run SCENE "
                        "makes and measures it; -o names its folder",
                        folder.string(), plan.beds.empty() ? "rods" : "dem"));
    if (!plan.beds.empty())
        require_same_beds(plan.scene, folder);
}

} // namespace rodwake::app
