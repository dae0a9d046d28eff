#pragma once
// Errors of a fit beyond its curvature (fitting/refits.hpp): constants that were held, masks, runs.

#include "rodwake/app/fit_results.hpp"

namespace rodwake::app {

/// Empty where the scene gives no reason: no fit.fixed_errors, one mask or none, tables of a single map.
/// Nothing if stop_requested of the method said so meanwhile. Throws RunError naming the key where a refit
/// fails.
std::optional<FitSystematics> fit_systematics(const FitPlan& plan, const fitting::Method& method,
                                              const FitResults& results);

/// A section of fit.txt; empty where there is nothing to say.
std::string to_text(const FitPlan& plan, const FitResults& results);

} // namespace rodwake::app
