#pragma once
// summary.json of one run and of an ensemble, runs.csv.

#include "granular_run.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

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

/// A number of a run, wherever it is written.
struct SummaryNumber {
    std::string path;        ///< in summary.json: "rods.0.force"
    std::string column;      ///< of runs.csv; "": none
    std::string scan_column; ///< of the tables of a scan; "": none
    std::string_view unit, meaning;
    OverRuns over_runs;
    std::function<double(const GranularSummary&)> of;
};

/// All of them, in the order of the columns; `rods` and `kinds` of beads: their numbers as text, or "<k>" for
/// all.
std::vector<SummaryNumber> summary_numbers(const std::vector<std::string>& rods, bool pair,
                                           const std::vector<std::string>& kinds = {});
/// "0", "1", ...
std::vector<std::string> numbers_to(std::size_t count);

/// Columns of runs.csv, and the numbers of summary.json.
std::vector<ColumnInfo> runs_columns();
std::vector<ColumnInfo> summary_values();

} // namespace rodwake::app
