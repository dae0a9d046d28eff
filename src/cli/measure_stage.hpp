#pragma once
// The measure stage: what the runs of a folder recorded on their way, or their trajectories, put together.

#include "measure_results.hpp"
#include "session.hpp"

namespace rodwake::cli {

/// Throws InputError, before anything is written, if measure.trajectory cannot be measured.
void require_trajectory(const scene::Scene& scene, const Options& options);

/// Throws InputError if there is nothing to measure in the folder.
StageEnd measure_folder(const scene::Scene& scene, const Options& options,
                        const std::filesystem::path& folder, const Logger& log);

} // namespace rodwake::cli
