#pragma once
// The measure stage: what the runs of a folder recorded on their way, or their trajectories, put together.

#include "measure_files.hpp"
#include "run/session.hpp"

namespace rodwake::app {

/// The files of one run of a bed; of a trajectory from elsewhere only that.
struct RunFiles {
    std::filesystem::path folder, trajectory;
    bool own = true; ///< made by this scene's granular run
};

/// What there is to measure of a case: its finished runs in a run folder, or measure.trajectory. Throws
/// InputError if there is nothing.
std::vector<RunFiles> finished_runs(const Case& one, const std::filesystem::path& folder, const Logger& log);

/// Throws InputError if there is nothing to measure in the folder.
StageEnd measure_folder(const Plan& plan, const RunContext& context, const std::filesystem::path& folder,
                        const Logger& log);

} // namespace rodwake::app
