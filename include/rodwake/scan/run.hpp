#pragma once
// A scan: the points of its design that the ledger does not hold yet are evaluated, and their results go to
// the ledger. Stopped at any moment, the same call goes on; the ledger is then that of an uninterrupted scan.

#include "rodwake/scan/audit.hpp"
#include "rodwake/scan/boundary.hpp"
#include "rodwake/scan/execute.hpp"
#include "rodwake/scan/ledger.hpp"

namespace rodwake::scan {

/// A share of the points, for jobs that know nothing of each other: those whose number in the order of
/// evaluation leaves the rest `index` when divided by `of`.
struct Part {
    std::int64_t index = 0, of = 1;
};

struct RunOptions {
    Part part;
    /// Points done, and points there are: of an adaptive scan those that are known to be needed so far.
    std::function<void(std::int64_t done, std::int64_t total)> on_progress;
};

struct Summary {
    bool complete = false;      ///< false: it was stopped
    std::int64_t requested = 0; ///< points of the design (places times runs); adaptive: of the full lattice
    std::int64_t evaluated = 0; ///< points in the ledger
    std::int64_t left = 0;      ///< known to be needed, and not there
    Audit audit;                ///< adaptive: its last round
    int audit_rounds = 0;
    std::int64_t found_by_audit = 0; ///< adaptive: places missed in all rounds, refined since
    std::vector<Leaf> leaves;        ///< adaptive
    std::vector<Curve> curves;       ///< with boundary_tolerance
    std::int64_t traced = 0;         ///< points evaluated to bisect them; the ledger keeps brackets only
    std::int64_t lost_crossings = 0; ///< edges where a point of the bisection failed: gaps of the curves
};

/// Throws InputError for a share of an adaptive scan, whose points depend on all results.
void require_part(const Design& design, Part part);

/// Throws InputError as require_part, RunError if the ledger cannot be written.
Summary run(const Design& design, Ledger& ledger, const Execute& execute, const RunOptions& options);

} // namespace rodwake::scan
