#pragma once
// The tables of a scan of beds: a row a point with means over its runs, and a row a run.

#include "rodwake/app/scan.hpp"
#include "rodwake/scan/ledger.hpp"

#include <filesystem>

namespace rodwake::app {

/// scan.csv, scan_runs.csv and scan.h5 with the same columns. Throws RunError.
void write_bed_results(const std::filesystem::path& folder, const ScanPlan& plan, const scan::Ledger& ledger);

} // namespace rodwake::app
