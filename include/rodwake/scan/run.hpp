#pragma once
// A scan: the points of its design that the ledger does not hold yet are evaluated, and their results go to
// the ledger. Stopped at any moment, the same call goes on; the ledger is then that of an uninterrupted scan.

#include "rodwake/scan/ledger.hpp"
#include "rodwake/scan/mpi.hpp"
#include "rodwake/scan/refinement.hpp"

namespace rodwake::scan {

// Boundaries between outcomes as curves: the edges of the finest cells whose ends differ are bisected, and
// the places where the outcome changes are joined from cell to cell.

/// Edges of finest cells between two outcomes, each once, in the order of their numbers, as brackets one edge
/// long. Ends that failed have no boundary.
std::vector<OutcomeChange> crossed_edges(const Refinement& refinement);

/// The middle of the bracket; its id is that of the edge.
Point middle(const Refinement& refinement, const OutcomeChange& crossing);
/// The half of the bracket whose ends differ: of two, where a third outcome lies between, the lower.
void bisect(OutcomeChange& crossing, const Result& at_middle);

struct BoundaryPoint {
    std::array<double, max_axes> at{};
    double error = 0.0; ///< half the bracket, as a fraction of its axis
};

/// A boundary between two outcomes. Two axes: points in order along it, closed if the last is the first. One
/// axis or three: all points between the two, unordered.
struct Curve {
    std::int32_t outcome_a = -1, outcome_b = -1; ///< a < b
    std::vector<BoundaryPoint> points;
};

std::vector<Curve> boundary_curves(const Refinement& refinement, std::span<const OutcomeChange> crossings);

// What an adaptive scan may have missed: random places in cells that were not divided are tried. The share of
// them that have another outcome than their cell estimates how much of that area is wrong.

struct Audit {
    std::int64_t tried = 0, missed = 0;

    double rate() const;
    /// Upper end of the 95 % interval (one-sided, Clopper and Pearson 1934); 1 if nothing was tried.
    double upper_bound() const;
};

/// Places of round `round`, distinct, in undivided cells that are not mixed; never a corner of one. Fewer
/// than asked for where there are not enough.
std::vector<Point> audit_points(const Refinement& refinement, const Design& design, std::uint32_t round);

/// Whether a result differs from the cell it lies in.
bool is_missed(const Refinement& refinement, const Result& result);

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

/// Evaluates those of the points that the ledger does not hold, and adds them to it. `learn` gets the results
/// of all, `report` is called after each chunk. Returns false if it was stopped. Throws RunError if the
/// ledger cannot be written.
bool evaluate_missing(Ledger& ledger, const Execute& execute, std::span<const Point> points,
                      const std::function<void(const Result&)>& learn, const std::function<void()>& report);

/// Throws InputError for a share of an adaptive scan, whose points depend on all results.
void require_part(const Design& design, Part part);

/// Throws InputError as require_part, RunError if the ledger cannot be written.
Summary run(const Design& design, Ledger& ledger, const Execute& execute, const RunOptions& options);

} // namespace rodwake::scan
