#pragma once
// A scene stands for several cases: itself as written and one for each of its [[variants]].

#include "rodwake/scene/scene.hpp"

#include <string>
#include <vector>

namespace rodwake::app {

struct Case {
    std::string name;   ///< of the variant; "scene" for the scene as written
    std::string label;  ///< for legends, where it may hold TeX; empty for the scene as written
    std::string folder; ///< where its files go, "" or "variants/<name>/"
    scene::Scene scene;

    /// " (name)" for messages; empty for the scene as written.
    std::string suffix() const { return label.empty() ? "" : " (" + name + ")"; }
};

/// The scene as written, then each variant.
std::vector<Case> cases_of(const scene::Scene& scene);

/// The scene as written, and its variants whose [granular] differs from it (others change the rods only).
std::vector<Case> bed_cases(const scene::Scene& scene);

} // namespace rodwake::app
