#pragma once
// The fit stage: [fit] solved and its files written.

#include "rodwake/app/fit_results.hpp"
#include "run/session.hpp"

#include <utility>

namespace rodwake::app {

struct FitStageResult {
    StageEnd end = StageEnd::failed;
    std::optional<FitResults> results; ///< absent if there is nowhere a finite residual
};

/// Starts and blocks of samples that are done are kept in the folder until forget_progress(); the same
/// command goes on from them.
FitStageResult fit_in_folder(const scene::Scene& scene, const FitPlan& plan, const RunContext& context,
                             const std::filesystem::path& folder, const Logger& log);

/// Of a fit that is finished, with all its rivals.
void forget_progress(const std::filesystem::path& folder);

/// What a fit depends on, as text: version, search, model and data.
std::string fit_key(const scene::Scene& scene, const FitPlan& plan);

/// Writes medium.json and makes the medium that of the later stages. Throws RunError if the fit does not fix
/// it.
void take_fitted_medium(Session& session, const FitResults& results, const FitPlan& plan);

/// eta and xi (f/mu) of a medium.json that an earlier fit wrote. Throws InputError.
std::pair<double, double> stored_medium(const std::filesystem::path& file);

} // namespace rodwake::app
