#pragma once

#include "rodwake/app/fit_results.hpp"

#include <string>

namespace rodwake::app {

/// Who made it, for fit.json.
struct FitOrigin {
    std::string command;
};

/// Content of fit.json.
std::string fit_json(const FitPlan& plan, const FitResults& results, const FitOrigin& origin);

} // namespace rodwake::app
