#pragma once
// Measures of what a camera saw: from the file that [tracks] names to tracks.json and the results of a case.

#include "measure_stage.hpp"
#include "run/describe_parts.hpp"

#include <optional>

namespace rodwake::app {

/// Throws InputError if the file that [tracks] names is not there.
void require_tracks(const scene::Scene& scene);

/// Of a scene with [tracks] and [measure]. Nothing if a signal stopped it. Throws InputError for a file that
/// is no film.
std::optional<CaseResults> measure_tracks(const Case& one, const RunContext& context,
                                          const std::filesystem::path& folder, const Logger& log);

/// Numbers of tracks.json.
std::span<const ColumnInfo> tracks_values();
/// Of film_frame.csv.
std::span<const ColumnInfo> film_frame_columns();

} // namespace rodwake::app
