#pragma once
// The tables of a scan: scan.csv, cells.csv and boundary.csv, and the datasets of scan.h5.

#include "rodwake/app/scan.hpp"
#include "rodwake/core/encounter.hpp"
#include "rodwake/scan/run.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/hdf5_writer.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <queue>
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

/// `certificates`: of each cell.
void write_cells(const std::filesystem::path& file, const ScanPlan& plan, const scan::Summary& summary,
                 const std::vector<Certificate>& certificates);
void write_boundary(const std::filesystem::path& file, const ScanPlan& plan, const scan::Summary& summary);

/// The group /points: a dataset a column, in the order in which points are added.
class PointColumns {
public:
    /// `rows`: how many points will be added. File and plan must outlive it.
    PointColumns(store::Hdf5Writer& h5, const ScanPlan& plan, std::int64_t rows);

    void add(std::span<const scan::Result> results);
    /// After the last point: the names of outcomes, states and words.
    void finish();

private:
    struct PointColumn {
        std::string name;
        std::function<double(const scan::Result&)> value;
    };

    store::Hdf5Writer& h5_;
    const ScanPlan& plan_;
    std::vector<PointColumn> columns_;
    std::size_t rows_, written_ = 0;
};

/// Points whose trajectories are stored: random, the same ones whoever evaluated them.
class TrajectorySample {
public:
    explicit TrajectorySample(std::size_t count) : count_(count) {}

    void add(const scan::Result& result);
    /// The group /trajectories, unless nothing was sampled: runs them again.
    void write(store::Hdf5Writer& h5, const ScanPlan& plan);

private:
    struct Stored {
        std::int64_t row = 0; ///< of scan.csv, from 0
        scan::Result result;
    };
    struct RankedPoint {
        std::uint64_t rank;
        Stored stored;
        bool operator<(const RankedPoint& other) const { return rank < other.rank; }
    };

    std::size_t count_;
    std::int64_t rows_ = 0;
    std::priority_queue<RankedPoint> kept_;
};

} // namespace rodwake::app
