#pragma once
// Which beds a scene has: the one as written and one for each variant that changes it. Where their runs go.

#include "dem_run.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace rodwake::cli {

struct DemCase {
    std::string name;   ///< of the variant; "scene" for the scene as written
    std::string label;  ///< for messages and legends; empty for the scene as written
    std::string folder; ///< where its files go, "" or "variants/<name>/"
    scene::Scene scene;
};

/// The scene as written, and its variants whose [granular] differs from it (others change the rods only).
std::vector<DemCase> dem_cases(const scene::Scene& scene);

/// The runs of a case, one folder each; who executes them is another matter.
std::vector<DemTask> dem_tasks(const DemCase& one, const std::filesystem::path& directory);

} // namespace rodwake::cli
