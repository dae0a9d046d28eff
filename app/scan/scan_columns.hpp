#pragma once

#include "rodwake/app/measure_report.hpp"

#include <span>

namespace rodwake::app {

/// Columns of scan.csv and scan_runs.csv beside the axes, which have the names of their keys. "{scan length}"
/// and "{scan time}" stand for a and s of beds, else for the units of the run's theory.
std::span<const ColumnInfo> scan_columns();

} // namespace rodwake::app
