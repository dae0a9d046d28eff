#pragma once
// The page of `rodwake explore`: one HTML file that computes wakes and encounters in a browser, with the
// kernels of models/elastic and models/rods compiled to WebAssembly (tools/explorer).

#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::app {

/// What of a scene the page starts from: its first two rods with coupling, medium, t_end and contact
/// distance.
struct ExplorerStart {
    scene::Scene scene;
    std::string name;
};

/// The page, from the files of `folder` (explorer/ of what is shipped). Throws InputError for a scene without
/// a medium or with fewer than two rods, RunError if a file cannot be read.
std::string explorer_page(const std::filesystem::path& folder, const std::optional<ExplorerStart>& start);

/// What of a scene the page leaves out, a line each.
std::vector<std::string> left_out_by_explorer(const scene::Scene& scene);

/// The page beside the report of a run that it shows.
inline constexpr const char* explorer_file = "explore.html";

/// Whether the page shows the scene's run as it is: two rods of the theory, and nothing left out.
bool shown_by_explorer(const scene::Scene& scene);

} // namespace rodwake::app
