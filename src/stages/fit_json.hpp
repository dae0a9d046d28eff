#pragma once

#include "rodwake/stages/fit_results.hpp"

#include <string>

namespace rodwake::stages {

/// Who made it, for fit.json.
struct FitOrigin {
    std::string command;
};

/// Content of fit.json.
std::string fit_json(const assembly::FitPlan& plan, const FitResults& results, const FitOrigin& origin);

} // namespace rodwake::stages
