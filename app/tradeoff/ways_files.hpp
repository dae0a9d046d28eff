#pragma once
// ways.json, to go on from, and ways.csv, to read.

#include "rodwake/app/measure_report.hpp"
#include "rodwake/app/ways.hpp"

#include <span>

namespace rodwake::app {

std::string ways_json(const Ways& ways, const std::string& command);
/// A row a way and quantity; ways without a result have one row.
std::string ways_csv(const Ways& ways);
std::span<const ColumnInfo> ways_columns();

} // namespace rodwake::app
