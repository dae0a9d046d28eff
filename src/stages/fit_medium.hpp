#pragma once
// medium.fitted: the medium of the rods and the field from what was fitted.

#include "rodwake/stages/fit_results.hpp"
#include "session.hpp"

#include <utility>

namespace rodwake::stages {

/// Writes medium.json and makes the medium that of the later stages. Throws RunError if the fit does not fix
/// it.
void take_fitted_medium(Session& session, const FitResults& results, const assembly::FitPlan& plan);

/// eta and xi (f/mu) of a medium.json that an earlier fit wrote. Throws InputError.
std::pair<double, double> stored_medium(const std::filesystem::path& file);

} // namespace rodwake::stages
