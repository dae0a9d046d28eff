#pragma once
// The files of a fit: fit.json, fit.txt, fit_profile_<i>.csv, fit_curve_<i>.csv, fit_trajectory_<i>.csv.

#include "fit_json.hpp"

namespace rodwake::app {

/// fit.json comes last: where it is, the others are.
void write_fit(const std::filesystem::path& folder, const FitPlan& plan, const FitResults& results,
               const FitOrigin& origin);

} // namespace rodwake::app
