#pragma once
// What fit.json says of maps and of errors beyond the curvature.

#include "rodwake/app/fit_results.hpp"

#include <nlohmann/json_fwd.hpp>

namespace rodwake::app {

nlohmann::ordered_json map_json(const FitPlan& plan, const FitResults& results, std::size_t i);

/// Null where the scene asks for none.
nlohmann::ordered_json systematics_json(const FitPlan& plan, const FitResults& results);

} // namespace rodwake::app
