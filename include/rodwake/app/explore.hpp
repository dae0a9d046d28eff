#pragma once
// The page of `rodwake explore`: one HTML file that computes wakes and encounters in a browser, with the
// kernels of models/elastic and models/rods compiled to WebAssembly (tools/explorer).

#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::app {

/// What of a scene the page starts from: its two rods with coupling, medium, t_end and contact distance.
struct ExplorerStart {
    scene::Scene scene;
    std::string name;
};

/// The page, from the files of `folder` (explorer/ of what is shipped). Throws InputError for a scene that it
/// does not show as it is, RunError if a file cannot be read.
std::string explorer_page(const std::filesystem::path& folder, const std::optional<ExplorerStart>& start);

/// Why the page cannot show the scene's run as it is, a line each; empty: it can.
std::vector<std::string> left_out_by_explorer(const scene::Scene& scene);

/// The page beside the report of a run that it shows.
inline constexpr const char* explorer_file = "explore.html";

} // namespace rodwake::app
