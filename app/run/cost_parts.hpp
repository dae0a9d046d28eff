#pragma once
// What `rodwake check` says of the cost of a stage: how long it will take, what that consists of and what
// would be saved by leaving a part out or loosening a setting. All of it is timed on this machine, on one
// thread, in about cost_budget seconds a stage.

#include "rodwake/app/plan.hpp"
#include "rodwake/app/run_context.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace rodwake::app {

inline constexpr double cost_budget = 0.5; ///< s

/// A part of a stage, or a setting that would change its cost.
struct CostRow {
    std::string term;            ///< "polar turning (gamma1, gamma2)"
    std::string each = {};       ///< "0.35 us a right-hand side"
    std::optional<double> share; ///< of the stage
    std::optional<double> saved; ///< of the stage, if the part is left out or the setting chosen; < 0: lost
};

/// Aligned columns, with a head.
std::string cost_table(std::span<const CostRow> rows);

/// "0.35 us", "1.2 ms", "64 s"
std::string duration_text(double seconds);
/// "12 %", "1.3 %", "< 0.1 %"
std::string percent_text(double share);

/// A line and a table each; plan has the stage.
std::string rods_cost(const Plan& plan, const std::filesystem::path& folder, const RunContext& context);
std::string bed_cost(const Plan& plan);
std::string bed_scan_cost(const Plan& plan);

} // namespace rodwake::app
