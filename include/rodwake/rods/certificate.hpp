#pragma once
// How well an outcome is known. docs/physics.md, section 7, derives the bounds.
//
//   proved    the exact solution ends so: its distance to every decision (contact, and the criteria of
//   pursuit
//             and escape) is larger than an a-posteriori bound of the error of the numerical one. Rounding in
//             the bound itself is allowed for, not enclosed
//   checked   a run at a tolerance a hundred times tighter ends so, and each decision is farther from its
//             limit than ten times what the two differ by
//   open      neither
//
// Proofs are of two rods on the plane in the exact field, and of any number that walk straight. Other runs
// are checked where a second one costs little, else open.
//
// Degenerate input: a run that failed or was interrupted, or with noise, is open; rods that start in contact
// are proved; a single rod has nothing to decide and is proved undecided.

#include "rodwake/core/encounter.hpp"
#include "rodwake/rods/pair_batch.hpp"

#include <span>
#include <vector>

namespace rodwake::rods {

/// As simulate, with RodOutcome::certificate.
RodResult simulate_certified(const RodProblem& problem, const RodOptions& options);

/// As simulate_pairs, with PairResult::certificate; pairs that are handed over stay open. Costs about as much
/// again, and the pairs that are not proved a second run.
void simulate_certified(std::span<const PairProblem> pairs, const PairOptions& options,
                        std::span<PairResult> results);

/// Whether all pairs between two end so. Those of a box whose opposite corners they are: couplings, places
/// and headings may differ, each by itself. Where it says no, some may end otherwise, or not.
bool all_end(const PairProblem& low, const PairProblem& high, Ending ending, const PairOptions& options);

} // namespace rodwake::rods
