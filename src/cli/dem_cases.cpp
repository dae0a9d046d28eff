#include "dem_cases.hpp"

#include "rodwake/scene/read.hpp"

#include <fmt/format.h>

namespace rodwake::cli {

std::vector<DemCase> dem_cases(const scene::Scene& scene) {
    std::vector<DemCase> cases = {{"scene", "", "", scene}};
    for (const scene::Variant& variant : scene.variants) {
        scene::Scene changed = scene::apply_variant(scene, variant);
        if (changed.granular && changed.granular != scene.granular)
            cases.push_back({variant.name, variant.label.empty() ? variant.name : variant.label,
                             "variants/" + variant.name + "/", std::move(changed)});
    }
    return cases;
}

std::vector<DemTask> dem_tasks(const DemCase& one, const std::filesystem::path& directory) {
    const long runs = one.scene.granular->runs;
    const std::filesystem::path folder = one.folder.empty() ? directory : directory / one.folder;
    std::vector<DemTask> tasks;
    for (std::uint32_t run = 0; run < static_cast<std::uint32_t>(runs); ++run)
        tasks.push_back({run, runs == 1 ? folder : folder / fmt::format("runs/{:04}", run + 1)});
    return tasks;
}

} // namespace rodwake::cli
