#pragma once

#include "rodwake/app/scan.hpp"
#include "rodwake/scan/run.hpp"
#include "rodwake/store/atomic_file.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace rodwake::app {

/// A cell of a table; empty if it is not finite.
std::string number_text(double value);
/// The values of a point on all axes, a comma behind each.
std::string place_text(const ScanPlan& plan, const scan::Point& point);
std::string outcome_text(const ScanPlan& plan, std::int32_t outcome);
/// With commas between them.
std::string axis_names(const ScanPlan& plan);

/// scan.csv of rods, many points at a time. The plan must outlive it; the file appears at commit.
class PointTable {
public:
    PointTable(const std::filesystem::path& file, const ScanPlan& plan);

    void add(std::span<const scan::Result> results, std::size_t threads);
    void commit() { pending_.commit(); }

private:
    static constexpr std::size_t rows_at_once = 1 << 10;

    store::PendingFile pending_;
    const ScanPlan& plan_;
    std::vector<std::string> texts_; ///< of blocks of rows
};

void write_cells(const std::filesystem::path& file, const ScanPlan& plan, const scan::Summary& summary);
void write_boundary(const std::filesystem::path& file, const ScanPlan& plan, const scan::Summary& summary);

} // namespace rodwake::app
