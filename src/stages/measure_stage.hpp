#pragma once
// The measure stage: what the runs of a folder recorded on their way, or their trajectories, put together.

#include "measure_results.hpp"
#include "session.hpp"

namespace rodwake::stages {

/// Throws InputError, before anything is written, if measure.trajectory cannot be measured.
void require_trajectory(const assembly::Plan& plan);

/// Throws InputError if there is nothing to measure in the folder.
StageEnd measure_folder(const assembly::Plan& plan, const RunContext& context,
                        const std::filesystem::path& folder, const Logger& log);

} // namespace rodwake::stages
