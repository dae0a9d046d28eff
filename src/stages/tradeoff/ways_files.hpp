#pragma once
// ways.json, to go on from, and ways.csv, to read.

#include "rodwake/assembly/measure_report.hpp"
#include "rodwake/stages/ways.hpp"

#include <span>

namespace rodwake::stages {

std::string ways_json(const Ways& ways, const std::string& command);
/// A row a way and quantity; ways without a result have one row.
std::string ways_csv(const Ways& ways);
std::span<const assembly::ColumnInfo> ways_columns();

} // namespace rodwake::stages
