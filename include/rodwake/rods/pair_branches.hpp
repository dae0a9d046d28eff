#pragma once
// Orbits and parallel pairs (pair_equilibria.hpp) followed over one number of the pair: branches and folds.
//
// In z = (ln(r/xi), b, p) the two equations (a) and (b) of a fixed point define curves. Each is followed by
// its arclength s: Euler's step along the unit tangent, then Newton's method for (a), (b) and the plane
// through the predicted point normal to the tangent (Keller 1977), which passes folds, where dp/ds = 0. p
// counts in the range asked for; a step is at most 0.05, and is halved where the tangent turns by more than
// 0.1 rad in it. A fold is bracketed by the sign of dp/ds and located by it to rounding in s, so p, of which
// it is an extremum, to 1e-12 of itself, and r to 1e-7. Two more kinds of end are reported: a branch of
// asymmetric orbits can be born from opposite rods, b = pi/2 (a pitchfork: its other half is the mirror image
// with the rods exchanged), and from rods in line, b = 0.
//
// Branches are started from pair_equilibria at 17 values of p: one that lives between two of them is missed.
//
// Degenerate input:
//   a range that is empty or not finite, eta <= -1, alpha <= 0      InputError
//   no coupling                                                     no branches
//   alpha without a polar coupling                                  lengths times alpha do not change
//   (similarity)

#include "rodwake/rods/pair_equilibria.hpp"

#include <string_view>

namespace rodwake::rods {

/// What may vary: "kappa", "gamma1", "gamma2", "eta" or "alpha" = (f/mu)/xi.
enum class BranchParameter { kappa, gamma1, gamma2, eta, alpha };
/// Throws InputError for other names.
BranchParameter branch_parameter(std::string_view name);

struct BranchPoint {
    double parameter;
    PairEquilibrium equilibrium;
    bool fold = false; ///< the branch turns round here
};

struct PairBranch {
    std::vector<BranchPoint> points; ///< in order along the branch, folds among them
    /// Why it stops there: "range" (of the parameter), "distance" (the limits of the search), "opposite",
    /// "in_line", "closed" (it returns to where it began), or "lost" (Newton's method failed).
    std::string first_end, last_end;
};

/// Branches with `least` <= p <= `most`; of the other numbers medium and couplings are taken.
std::vector<PairBranch> pair_branches(const elastic::Medium& medium, const Couplings& couplings,
                                      BranchParameter over, double least, double most);

} // namespace rodwake::rods
