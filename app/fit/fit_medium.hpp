#pragma once
// medium.fitted: the medium of the rods and the field from what was fitted.

#include "rodwake/app/fit_results.hpp"
#include "run/session.hpp"

#include <utility>

namespace rodwake::app {

/// Writes medium.json and makes the medium that of the later stages. Throws RunError if the fit does not fix
/// it.
void take_fitted_medium(Session& session, const FitResults& results, const FitPlan& plan);

/// eta and xi (f/mu) of a medium.json that an earlier fit wrote. Throws InputError.
std::pair<double, double> stored_medium(const std::filesystem::path& file);

} // namespace rodwake::app
