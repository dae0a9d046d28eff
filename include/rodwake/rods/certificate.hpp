#pragma once
// How well an outcome is known. docs/numerics.md, section 4, has the bounds.
//
//   verified  rods that walk straight: the closed form ends so, and every decision (contact, and the criteria
//             of pursuit and escape) is farther from its limit than its rounding. Two that turn, on the plane
//             in the exact field at eta >= 0: as far as an a-posteriori bound of the error of the run, or of
//             one at a tighter tolerance. Rounding in the bound itself is allowed for, not
//             enclosed. And rods that start well within the contact distance, and a single one, which has
//             nothing to decide
//   checked   other rods that turn: a run at a tolerance a hundred times tighter ends so, and each decision
//   is
//             farther from its limit than ten times what the two differ by. Evidence, not a proof
//   open      neither
//
// Degenerate input: open are a run that failed or was interrupted, or with noise; more than
// most_followed_rods rods; rods with bodies, for whose contacts there is no bound; straight walkers in a
// periodic box, whose images are not gone through. With rtol
// below 1e-11 nothing is checked, as no tolerance is a hundred times tighter.

#include "rodwake/core/encounter.hpp"
#include "rodwake/rods/pair_batch.hpp"

#include <span>

namespace rodwake::rods {

/// Whether nothing turns or pushes the rods.
bool walks_straight(const RodProblem& problem);

/// Of rods that start in contact, by the separation of `met`.
Certificate certificate_at_start(const RodProblem& problem, const RodOutcome& met);

/// As simulate, with RodOutcome::certificate. A second run is made where it takes some milliseconds, or, if
/// `thorough`, always.
RodResult simulate_certified(const RodProblem& problem, const RodOptions& options, bool thorough = false);

/// As simulate_pairs, with PairResult::certificate; pairs that are handed over stay open. Those that the
/// steps of the run do not verify are run again, at most twice.
void simulate_certified(std::span<const PairProblem> pairs, const PairOptions& options,
                        std::span<PairResult> results);

/// Whether all pairs between these end so: couplings, places and headings may be any within the range that
/// these have, each by itself. Where it says no, some may end otherwise, or not.
bool all_end(std::span<const PairProblem> corners, Ending ending, const PairOptions& options);

} // namespace rodwake::rods
