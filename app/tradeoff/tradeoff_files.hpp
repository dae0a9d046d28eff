#pragma once

#include "rodwake/app/measure_report.hpp"
#include "rodwake/app/tradeoff.hpp"
#include "rodwake/app/ways.hpp"

#include <span>

namespace rodwake::app {

std::string tradeoff_json(const Tradeoff& table);
/// A row a trial, in the order in which they were tried.
std::string tradeoff_csv(const Tradeoff& table);
std::span<const ColumnInfo> tradeoff_columns();

// ways.json, to go on from, and ways.csv, to read.

std::string ways_json(const Ways& ways, const std::string& command);
/// A row a way and quantity; ways without a result have one row.
std::string ways_csv(const Ways& ways);
std::span<const ColumnInfo> ways_columns();

} // namespace rodwake::app
