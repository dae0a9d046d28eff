#pragma once
// The files of a scan, made from its ledger at the end and when it is interrupted. Memory: one column of
// doubles at a time, and what summary holds; a table of any length goes through row by row.

#include "rodwake/app/rods.hpp"
#include "rodwake/app/scan.hpp"
#include "rodwake/scan/ledger.hpp"
#include "rodwake/scan/run.hpp"

#include <filesystem>

namespace rodwake::app {

inline bool of_beds(const ScanPlan& plan) { return plan.subject == scene::ScanSubject::beds; }

/// scan.csv, scan.h5 (with the sample of trajectories), scan.json; cells.csv and boundary.csv where there are
/// cells and boundaries; of beds what scan_bed_results.hpp says. Throws RunError.
void write_scan(const std::filesystem::path& folder, const ScanPlan& plan, const scene::Scan& keys,
                const scan::Ledger& ledger, const scan::Counts& counts, const scan::Summary& summary,
                double wall_seconds, std::size_t threads);

/// scan.csv, scan_runs.csv and scan.h5 with the same columns. Throws RunError.
void write_bed_results(const std::filesystem::path& folder, const ScanPlan& plan, const scan::Ledger& ledger);

} // namespace rodwake::app
