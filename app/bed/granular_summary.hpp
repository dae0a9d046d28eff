#pragma once
// summary.json of one run and of an ensemble, runs.csv.

#include "granular_run.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace rodwake::app {

/// Summed over the runs.
RunCost cost_of(std::span<const GranularSummary> runs);
/// As the scene asks for it: with the rods' shadows where they count; of a given number of beads their share.
double phi_b(const BedPlan& bed);
std::string summary_json(const BedPlan& bed, const GranularSummary& summary);
/// Means with standard errors over the runs.
std::string ensemble_json(const BedPlan& bed, std::span<const GranularSummary> runs, std::size_t asked);
std::string ensemble_csv(const granular::GranularProblem& problem, std::span<const GranularSummary> runs);

/// What an earlier command wrote with summary_json; nothing if there is no such file or it cannot be read.
std::optional<GranularSummary> read_summary(const std::filesystem::path& file,
                                            const granular::GranularProblem& problem, std::uint32_t run);

} // namespace rodwake::app
