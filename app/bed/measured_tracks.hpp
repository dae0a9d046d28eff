#pragma once
// Measures of what a camera saw: from the file that [tracks] names to tracks.json and the results of a case.

#include "measure_stage.hpp"
#include "run/describe_parts.hpp"

#include <optional>

namespace rodwake::app {

/// Opens the files that [tracks] names and returns what their reader warns of. Throws InputError, as the run
/// does, if one is not there, or is a table without a column that is needed.
std::vector<std::string> require_tracks(const scene::Scene& scene);

/// Of a scene with [tracks] and [measure]. Nothing if a signal stopped it. Throws InputError for a file that
/// is no film.
std::optional<CaseResults> measure_tracks(const Case& one, const RunContext& context,
                                          const std::filesystem::path& folder, const Logger& log);

/// Numbers of tracks.json.
std::span<const ColumnInfo> tracks_values();

} // namespace rodwake::app
