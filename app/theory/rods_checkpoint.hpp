#pragma once
// Checkpoints of a rod run beside its results, each a journal of one record whose key is the version, the
// scene and the field to which it belongs.

#include "rodwake/app/rods.hpp"
#include "rodwake/rods/simulate.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace rodwake::app {

/// The content of the file.
std::string checkpoint_bytes(const rods::RodCheckpoint& checkpoint, const scene::Scene& scene,
                             const std::string& field);

/// The checkpoint in a file; nothing if there is none, it is damaged, or it belongs to another scene.
std::optional<rods::RodCheckpoint> read_checkpoint(const std::filesystem::path& file,
                                                   const scene::Scene& scene, const std::string& field);

/// The end of a run is kept with its last row alone. Takes the others from rods.csv, to the bits that are
/// written there. Returns false if the table is not of the run that ended so.
bool take_rows(const std::filesystem::path& table, const OutputUnits& units, rods::RodCheckpoint& end);

} // namespace rodwake::app
