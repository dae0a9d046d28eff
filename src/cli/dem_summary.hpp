#pragma once
// summary.json of one run and of an ensemble, runs.csv.

#include "dem_run.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace rodwake::cli {

std::string summary_json(const DemPlan& plan, const DemSummary& summary);
/// Means with standard errors over the runs.
std::string ensemble_json(const DemPlan& plan, std::span<const DemSummary> runs, std::size_t asked);
std::string ensemble_csv(const DemPlan& plan, std::span<const DemSummary> runs);

/// What an earlier command wrote with summary_json; nothing if there is no such file or it cannot be read.
std::optional<DemSummary> read_summary(const std::filesystem::path& file, const DemPlan& plan,
                                       std::uint32_t run);

} // namespace rodwake::cli
