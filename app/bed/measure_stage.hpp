#pragma once
// The measure stage: what the runs of a folder recorded on their way, or their trajectories, put together.

#include "bed/measure_kind.hpp"
#include "bed/measure_report.hpp"
#include "rodwake/store/hdf5_writer.hpp"
#include "run/session.hpp"
#include "series_row.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rodwake::app {

// What was measured of one case (the scene as written, or a variant), all its runs together, and its files.

struct CaseResults {
    SeriesRow row;
    std::string label, folder;                                     ///< Case
    std::vector<std::pair<std::string, MeasureReport>> reports;    ///< of each measure that could be had
    std::vector<std::pair<std::string, std::string>> not_measured; ///< what was wanted and why it is missing
};

/// Who measured, how.
struct MeasureOrigin {
    std::string command;
    std::uint64_t seed = 0;
};

/// measure.json, measure.h5, *.csv, *.vti of a case. Lengths in bead radii. Throws RunError.
void write_measures(const std::filesystem::path& folder, const CaseResults& results,
                    const MeasureOrigin& origin);

/// series.csv: a row for each case; series.json: what measures tell of all cases together, if any does.
/// Throws RunError.
void write_series(const std::filesystem::path& folder, const std::vector<CaseResults>& cases);

/// Of each measure that is wanted and can be made of these data: its report, or why it cannot be had.
void report_measures(const MeasuredCase& data, CaseResults& results);

/// A few lines for the terminal.
std::vector<std::string> describe(const CaseResults& results);

/// A group of measure.h5; `a`: the bead radius, m. Throws RunError.
void put_grid(store::Hdf5Writer& out, const MeasureGrid& grid, double a);

/// The files of one run of a bed; of a trajectory from elsewhere only that.
struct RunFiles {
    std::filesystem::path folder, trajectory;
    bool own = true; ///< made by this scene's granular run
};

/// What there is to measure of a case: its finished runs in a run folder, or measure.trajectory. Throws
/// InputError if there is nothing.
std::vector<RunFiles> finished_runs(const Case& case_, const std::filesystem::path& folder,
                                    const Logger& log);

/// Throws InputError if there is nothing to measure in the folder.
StageEnd measure_folder(const Plan& plan, const RunContext& context, const std::filesystem::path& folder,
                        const Logger& log);

} // namespace rodwake::app
