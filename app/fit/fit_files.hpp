#pragma once
// The files of a fit: fit.json, fit.txt, fit_profile_<i>.csv, fit_curve_<i>.csv, fit_trajectory_<i>.csv.

#include "rodwake/app/fit_results.hpp"

#include <filesystem>
#include <string>

namespace rodwake::app {

/// Who made it, for fit.json.
struct FitOrigin {
    std::string command;
};

/// fit.json comes last: where it is, the others are.
void write_fit(const std::filesystem::path& folder, const FitPlan& plan, const FitResults& results,
               const FitOrigin& origin);

} // namespace rodwake::app
