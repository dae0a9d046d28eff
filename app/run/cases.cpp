#include "rodwake/app/cases.hpp"

#include "rodwake/scene/read.hpp"

namespace rodwake::app {

std::vector<Case> cases_of(const scene::Scene& scene) {
    std::vector<Case> cases = {{"scene", "", "", scene}};
    for (const scene::Variant& variant : scene.variants)
        cases.push_back({variant.name, variant.label.empty() ? variant.name : variant.label,
                         "variants/" + variant.name + "/", scene::apply_variant(scene, variant)});
    return cases;
}

std::vector<Case> bed_cases(const scene::Scene& scene) {
    std::vector<Case> cases = cases_of(scene);
    std::erase_if(cases, [&](const Case& one) {
        return !one.folder.empty() && (!one.scene.granular || one.scene.granular == scene.granular);
    });
    return cases;
}

} // namespace rodwake::app
