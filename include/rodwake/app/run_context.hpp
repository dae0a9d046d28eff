#pragma once
// What a stage needs of the outside, and all it gets: a terminal, a script and a test give each their own.

#include "rodwake/scan/run.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::app {

enum class Severity { debug, info, warning, error };

/// How far a stage is: `value` of `end`, in `unit`.
struct ProgressReport {
    std::string_view what; ///< "rods", "dem", "measure", "fit"
    double begin = 0.0;    ///< value where this command started: what an earlier one did took it no time
    double value = 0.0, end = 0.0;
    std::string_view unit;
};

/// What a scan is asked for beside its scene.
struct ScanRequest {
    scan::Part part;           ///< a share of the points
    bool merge = false;        ///< take over what shares of the scan have in the folders part-*-of-*
    bool rerun_failed = false; ///< points that failed are evaluated again
};

struct RunContext {
    std::size_t threads = 0;           ///< 0: one for each core
    std::optional<std::uint64_t> seed; ///< replaces those of the scene
    bool force = false;                ///< redo what is there already
    bool draws = false;                ///< figures of what the stages leave follow
    std::string command;               ///< what makes the run again, for provenance
    std::function<void(Severity, const std::string&)> log;
    std::function<void(const ProgressReport&)> progress; ///< called often, and never from two threads at once
    std::function<bool()> stop;                          ///< true: end at the next step, keep what is done
    std::function<int()> checkpoint_requests; ///< how often a checkpoint was asked for; granular runs compare

    /// The command that reads and writes films of other programs (convert.hpp): an interpreter and its file.
    std::vector<std::string> converter;
    ScanRequest scan;
    /// Who evaluates the points of a scan, and runs the beds; empty: threads of this process.
    std::function<scan::Execute(scan::Evaluate, std::function<bool()> stop)> executor;

    /// `threads`, settled.
    std::size_t thread_count() const;
    bool stopped() const { return stop && stop(); }
};

/// How a stage ended; what it computed is kept in each case. `incomplete`: finished, but some points of a
/// scan failed.
enum class StageEnd { finished, failed, interrupted, incomplete };

} // namespace rodwake::app
