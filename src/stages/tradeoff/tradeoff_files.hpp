#pragma once

#include "rodwake/assembly/measure_report.hpp"
#include "rodwake/stages/tradeoff.hpp"

#include <span>

namespace rodwake::stages {

std::string tradeoff_json(const Tradeoff& table);
/// A row a trial, in the order in which they were tried.
std::string tradeoff_csv(const Tradeoff& table);
std::span<const assembly::ColumnInfo> tradeoff_columns();

} // namespace rodwake::stages
