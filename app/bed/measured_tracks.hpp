#pragma once
// Measures of what a camera saw: from the file that [tracks] names to tracks.json and the results of a case.

#include "measure_stage.hpp"
#include "run/describe_parts.hpp"

#include <complex>
#include <optional>
#include <vector>

namespace rodwake::app {

/// Opens the files that [tracks] names, as far as their first rows. Lines on what the readers assume there,
/// and, with a context to run the converter in, on what the first frames of other formats hold. Throws
/// InputError for what the run would refuse there.
std::vector<std::string> look_at_tracks(const scene::Scene& scene, const RunContext* context);

/// Of a scene with [tracks] and [measure]. Nothing if a signal stopped it. Throws InputError for a file that
/// is no film.
std::optional<CaseResults> measure_tracks(const Case& case_, const RunContext& context,
                                          const std::filesystem::path& folder, const Logger& log);

/// Numbers of tracks.json.
std::span<const ColumnInfo> tracks_values();
/// psi_6 of each bead by the rule and cut-off of measure.order, while its sums are there; NaN too near the
/// border of a window for all neighbours to be seen, and where order is not measured.
std::vector<std::complex<double>> local_order(const scene::Scene& scene, measure::Measures& sums,
                                              const Column& x, const Column& y);
/// Of film_frame.csv.
std::span<const ColumnInfo> film_frame_columns();

} // namespace rodwake::app
