#pragma once
// manifest.json: every file of a run folder, what it is, and its columns with units.

#include <filesystem>
#include <string>

namespace rodwake::stages {

/// {"files": {name: {what, stage, columns: [{name, unit, meaning}]}}} of the files that are there; names with
/// their folder.
std::string manifest_json(const std::filesystem::path& folder);

} // namespace rodwake::stages
