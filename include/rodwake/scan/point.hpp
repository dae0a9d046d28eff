#pragma once
// A point of a scan and what it yields. Plain data of fixed size: chunks of them go between threads and ranks
// as they are.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::scan {

inline constexpr std::size_t max_axes = 6, max_observables = 26, max_cause = 384;

struct Point {
    std::int64_t id = 0;               ///< points are sorted by it
    std::array<double, max_axes> at{}; ///< value on each axis; of an axis of words the index of the word
};

/// Where results are random, each place of a design is evaluated in several runs (Design::runs). The id of a
/// run does not depend on how many there are, so that more of them go on with those that are known.
inline constexpr int run_bits = 20;
inline constexpr long max_runs = 1L << run_bits;
constexpr std::int64_t id_of_run(std::int64_t index, std::int64_t run) { return (index << run_bits) + run; }
/// Both from 0.
constexpr std::int64_t place_of_run(std::int64_t id) { return id >> run_bits; }
constexpr std::int64_t run_of(std::int64_t id) { return id & (max_runs - 1); }

/// `stopped`: the scan was stopped while it was evaluated, and it is as if it had not been begun.
enum class Status : std::int32_t { ok, failed, time_limit, not_finite, exception, stopped };
inline constexpr const char* status_names[] = {"ok",         "failed",    "time_limit",
                                               "not_finite", "exception", "stopped"};

/// Failures are values: `values` and `outcome` mean something only if the status is ok.
struct Result {
    Point point;
    Status status = Status::ok;
    std::int32_t outcome = -1;                    ///< index into Columns::outcomes; -1: none
    std::int32_t retries = 0;                     ///< attempts before the last
    double seconds = 0.0;                         ///< wall time of all attempts
    std::array<double, max_observables> values{}; ///< as Columns::observables; NaN: there is none
    std::array<char, max_cause> cause{};          ///< of a failure, or of the retries; ends with 0

    bool ok() const { return status == Status::ok; }
    std::string_view cause_text() const { return cause.data(); }
    /// Cut to what fits.
    void set_cause(std::string_view text);
};

/// The text with `#` for each number: failures that differ in nothing else have one cause.
std::string cause_pattern(std::string_view text);

/// What the numbers of a result are called.
struct Columns {
    std::vector<std::string> outcomes;
    std::vector<std::string> observables; ///< at most max_observables
};

/// Results of points, one for one. Called from several threads at once. Failures of points are results; what
/// it throws ends the scan.
using Evaluate = std::function<void(std::span<const Point>, std::span<Result>)>;

} // namespace rodwake::scan
