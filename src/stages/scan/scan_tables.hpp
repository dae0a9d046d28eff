#pragma once

#include "rodwake/assembly/scan.hpp"
#include "rodwake/scan/run.hpp"

#include <filesystem>

namespace rodwake::stages {

void write_points(const std::filesystem::path& file, const assembly::ScanPlan& plan,
                  const scan::Ledger& ledger);
void write_cells(const std::filesystem::path& file, const assembly::ScanPlan& plan,
                 const scan::Summary& summary);
void write_boundary(const std::filesystem::path& file, const assembly::ScanPlan& plan,
                    const scan::Summary& summary);

} // namespace rodwake::stages
