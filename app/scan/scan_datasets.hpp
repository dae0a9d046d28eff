#pragma once
// scan.h5 of rods: the points as columns, and a sample of trajectories. Points are added some at a time, so
// that the ledger is read once for all that is made of it, and memory does not grow with it.

#include "rodwake/app/scan.hpp"
#include "rodwake/store/hdf5_writer.hpp"

#include <functional>
#include <queue>

namespace rodwake::app {

/// The group /points: a dataset a column, in the order in which points are added.
class PointColumns {
public:
    /// `rows`: how many points will be added. File and plan must outlive it.
    PointColumns(store::Hdf5Writer& h5, const ScanPlan& plan, std::int64_t rows);

    void add(std::span<const scan::Result> results);
    /// After the last point: the names of outcomes, states and words.
    void finish();

private:
    struct Column {
        std::string name;
        std::function<double(const scan::Result&)> value;
    };
    static std::vector<Column> columns_of(const ScanPlan& plan);

    store::Hdf5Writer& h5_;
    const ScanPlan& plan_;
    std::vector<Column> columns_;
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
    struct Entry {
        std::uint64_t rank;
        Stored stored;
        bool operator<(const Entry& other) const { return rank < other.rank; }
    };
    struct Paths;
    std::vector<Stored> take();
    static void add_path(Paths& paths, const Stored& one, const ScanPlan& plan);

    std::size_t count_;
    std::int64_t rows_ = 0;
    std::priority_queue<Entry> kept_;
};

} // namespace rodwake::app
