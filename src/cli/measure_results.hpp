#pragma once
// What was measured of one case (the scene as written, or a variant), all its runs together, and its files.

#include "dem_cases.hpp"
#include "rodwake/measure/pairs.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::cli {

/// Of rod measure.rod: the momentum it hands to the beads along its heading per time, and its speed.
struct ForceResult {
    measure::Estimate force; ///< N
    measure::Estimate speed; ///< m/s
};

struct CaseResults {
    std::string name, label, folder;                             ///< DemCase
    double bead_radius = 0.0, phi_b = 0.0, profile_offset = 0.0; ///< m, 1, m
    std::optional<double> separation;    ///< two rods: of their centres at the start, m
    std::optional<double> imposed_speed; ///< of the rod, m/s
    std::size_t runs = 0;
    std::optional<measure::StructureResult> structure;
    std::optional<measure::MicrorheologyResult> microrheology;
    std::optional<measure::FlowField> flow;
    std::optional<measure::DisplacementField> displacement;
    std::optional<measure::PairResult> pairs;
    std::optional<ForceResult> force;
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

/// series.csv: a row for each case; series.json: the line of force against imposed speed, where there is one.
/// Throws RunError.
void write_series(const std::filesystem::path& folder, const std::vector<CaseResults>& cases);

/// A few lines for the terminal.
std::vector<std::string> describe(const CaseResults& results);

} // namespace rodwake::cli
