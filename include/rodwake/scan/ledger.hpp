#pragma once
// The ledger of a scan: an SQLite file written chunk by chunk while the scan goes on, and read by it when it
// is taken up. One process writes; others may read meanwhile. Points that failed or were retried are rows:
//
//   SELECT "coupling.kappa", status, cause FROM causes;
//
// The others are records of one length, a chunk of them a row of `chunks`; docs/scans.md reads them with
// numpy.
//
// What was taken is committed before the call returns: a process that is killed loses the points in flight. A
// machine that goes down may lose the last second, and never leaves half a row. On a network file system
// SQLite needs working POSIX locks.

#include "rodwake/scan/design.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <optional>

namespace rodwake::scan {

/// What a ledger is of. Two of the same text and columns can be one.
struct LedgerHead {
    std::string description; ///< the scene as far as points depend on it
    std::vector<Axis> axes;
    Columns columns;
    bool repeated = false; ///< points are runs (Design::runs): the table tells point and run of each, from 1
};

struct Counts {
    std::int64_t points = 0, failed = 0;
    std::map<std::string, std::int64_t> outcomes; ///< of points that did not fail
    /// Of points that failed; causes that differ in numbers only are one, in the words of its first point.
    std::map<std::string, std::int64_t> causes;
    std::map<std::string, std::int64_t> examples; ///< id of that point
    double seconds = 0.0;                         ///< summed over points
};

/// An edge of the refinement whose ends have different outcomes, and where along it the outcome changes.
struct Crossing {
    std::int64_t id = 0; ///< of the edge: that of its lower end times the axes, plus its axis
    std::int32_t outcome_low = -1, outcome_high = -1;
    double u_low = 0.0, u_high = 1.0; ///< the bracket, as fractions of the edge's axis
};

class Ledger {
public:
    static constexpr int format = 2; ///< 1 had a row a point

    /// Makes the file or opens it. Throws InputError for one of another scan, of a newer version of rodwake,
    /// or that is no ledger; RunError if it cannot be written.
    Ledger(const std::filesystem::path& file, LedgerHead head);
    ~Ledger();
    Ledger(const Ledger&) = delete;
    Ledger& operator=(const Ledger&) = delete;

    const LedgerHead& head() const { return head_; }

    /// In one transaction; a point that is there already is replaced. Throws RunError (disk full).
    void add(std::span<const Result> results);
    void add(std::span<const Crossing> crossings);
    /// All that another ledger of the same scan holds and this one does not. Throws InputError.
    void merge(const std::filesystem::path& other);
    /// Removes points that failed, so that they are evaluated again, and brackets with such an end; how many
    /// points.
    std::int64_t forget_failed();
    /// Removes these points, so that they are evaluated again.
    void forget(std::span<const std::int64_t> ids);

    /// In the order of the points. `each` must not write.
    void for_each(const std::function<void(const Result&)>& each) const;
    void for_each_id(const std::function<void(std::int64_t)>& each) const;
    /// Those of these points that are there, in the order of all. Reads the whole ledger, unless none is
    /// there.
    std::vector<Result> find(std::span<const Point> points) const;
    std::optional<Result> find(std::int64_t id) const;
    std::vector<Crossing> crossings() const;
    std::int64_t points() const;
    Counts counts() const;

    /// Folds the write-ahead log into the file, so that it can be copied.
    void settle();

private:
    class Database;
    LedgerHead head_;
    std::unique_ptr<Database> database_;
};

/// What stands in a ledger whatever it is of, for `rodwake info`. Throws InputError.
Counts counts_of(const std::filesystem::path& file);

} // namespace rodwake::scan
