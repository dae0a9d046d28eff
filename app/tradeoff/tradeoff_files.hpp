#pragma once

#include "rodwake/app/measure_report.hpp"
#include "rodwake/app/tradeoff.hpp"

#include <span>

namespace rodwake::app {

std::string tradeoff_json(const Tradeoff& table);
/// A row a trial, in the order in which they were tried.
std::string tradeoff_csv(const Tradeoff& table);
std::span<const ColumnInfo> tradeoff_columns();

} // namespace rodwake::app
