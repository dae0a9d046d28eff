#pragma once
// `rodwake check` says what a stage costs: how many evaluations, steps or points it takes, where
// that is known beforehand, and the CPU time of one, which is measured on this machine on one thread. `cost`
// of StageKind returns such lines.

#include "rodwake/app/plan.hpp"
#include "rodwake/app/run_context.hpp"

#include <filesystem>
#include <string>

namespace rodwake::app {

inline constexpr double cost_budget = 0.2; ///< s of timing, at most, in a stage

/// "0.35 us", "1.2 ms", "64 s"
std::string duration_text(double seconds);

std::string bed_cost(const Plan& plan);
std::string bed_scan_cost(const Plan& plan);

} // namespace rodwake::app
