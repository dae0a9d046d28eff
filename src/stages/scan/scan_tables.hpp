#pragma once

#include "rodwake/assembly/scan.hpp"
#include "rodwake/scan/run.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace rodwake::stages {

/// A cell of a table; empty if it is not finite.
std::string number_text(double value);
std::string axis_text(const scan::Axis& axis, double value);
/// The values of a point on all axes, a comma behind each.
std::string place_text(const assembly::ScanPlan& plan, const scan::Point& point);
std::string outcome_text(const assembly::ScanPlan& plan, std::int32_t outcome);
/// With commas between them.
std::string axis_names(const assembly::ScanPlan& plan);

void write_points(const std::filesystem::path& file, const assembly::ScanPlan& plan,
                  const scan::Ledger& ledger);
void write_cells(const std::filesystem::path& file, const assembly::ScanPlan& plan,
                 const scan::Summary& summary);
void write_boundary(const std::filesystem::path& file, const assembly::ScanPlan& plan,
                    const scan::Summary& summary);

} // namespace rodwake::stages
