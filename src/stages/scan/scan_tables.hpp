#pragma once

#include "rodwake/assembly/scan.hpp"
#include "rodwake/scan/run.hpp"
#include "rodwake/store/atomic_file.hpp"

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

/// scan.csv of rods, point by point. The plan must outlive it; the file appears at commit.
class PointTable {
public:
    PointTable(const std::filesystem::path& file, const assembly::ScanPlan& plan);

    void add(const scan::Result& result);
    void commit();

private:
    void flush();

    store::PendingFile pending_;
    const assembly::ScanPlan& plan_;
    std::string text_; ///< not written yet
};

void write_cells(const std::filesystem::path& file, const assembly::ScanPlan& plan,
                 const scan::Summary& summary);
void write_boundary(const std::filesystem::path& file, const assembly::ScanPlan& plan,
                    const scan::Summary& summary);

} // namespace rodwake::stages
