#pragma once
// Checkpoints of a rod run as JSON beside its results. A checkpoint belongs to one scene: it holds the
// scene's text.

#include "rodwake/rods/simulate.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace rodwake::app {

std::string checkpoint_json(const rods::RodCheckpoint& checkpoint, const scene::Scene& scene,
                            const std::string& field);

/// The checkpoint in a file; nothing if there is none, it is damaged, or it belongs to another scene.
std::optional<rods::RodCheckpoint> read_checkpoint(const std::filesystem::path& file,
                                                   const scene::Scene& scene, const std::string& field);

} // namespace rodwake::app
