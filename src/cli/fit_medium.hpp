#pragma once
// medium.fitted: the medium of the rods and the field from what was fitted.

#include "fit_results.hpp"
#include "session.hpp"

namespace rodwake::cli {

/// Writes medium.json and makes the medium that of the later stages. Throws RunError if the fit does not fix
/// it.
void take_fitted_medium(Session& session, const FitResults& results, const FitPlan& plan);

} // namespace rodwake::cli
