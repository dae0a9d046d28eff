#pragma once
// The ledger of a scan: a journal (store/journal.hpp) of chunks of points, written while the scan goes on and
// read when it is resumed. One process writes, others may read meanwhile. Later records replace earlier ones.
//
// What was added is with the system before the call returns: a process that is killed loses the points in
// flight. A machine that goes down may lose the last seconds; what is left is whole, by checksums.

#include "rodwake/scan/design.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <optional>

namespace rodwake::scan {

/// Its name in the folder of a scan.
inline constexpr const char* ledger_file = "points.log";

/// What a ledger is of. Two of the same text and columns can be one.
struct LedgerHead {
    std::string description; ///< the scene as far as points depend on it
    std::vector<Axis> axes;
    Columns columns;
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
struct OutcomeChange {
    std::int64_t id = 0; ///< of the edge: that of its lower end times the axes, plus its axis
    std::int32_t outcome_low = -1, outcome_high = -1;
    double u_low = 0.0, u_high = 1.0; ///< the bracket, as fractions of the edge's axis
};
using Crossing [[deprecated("it is OutcomeChange")]] = OutcomeChange;

class Ledger {
public:
    /// Makes the file or opens it. Throws InputError for one of another scan, of another version of rodwake,
    /// or that is no ledger; RunError if it cannot be written.
    Ledger(const std::filesystem::path& file, LedgerHead head);
    /// To read what a scan has so far. Throws InputError.
    explicit Ledger(const std::filesystem::path& file);
    ~Ledger();
    Ledger(const Ledger&) = delete;
    Ledger& operator=(const Ledger&) = delete;

    const LedgerHead& head() const { return head_; }

    /// A point that is there already is replaced. Throws RunError (disk full).
    void add(std::span<const Result> results);
    void add(std::span<const OutcomeChange> crossings);
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
    /// The results of these points that are there, in the order of all.
    std::vector<Result> find(std::span<const Point> points) const;
    std::optional<Result> find(std::int64_t id) const;
    std::vector<OutcomeChange> crossings() const;
    std::int64_t points() const;
    Counts counts() const;
    /// Records that were damaged when the file was opened; their points are not there.
    std::int64_t damaged() const;

    /// All on the disk.
    void sync();

private:
    class Book;
    LedgerHead head_;
    std::unique_ptr<Book> book_;
};

/// Throws InputError for a ledger of another scan, of another version of rodwake, or a file that is none.
void require_ledger(const std::filesystem::path& file, const LedgerHead& head);

/// What is in a ledger, without its scene, for `rodwake info`. Throws InputError.
Counts counts_of(const std::filesystem::path& file);

} // namespace rodwake::scan
