#pragma once
// How an encounter of two rods ends. The paper knows capture and no capture; solving shows three ends, and a
// run can stop before any of them is reached.
//
//   contact    the separation fell to the contact distance
//   pursuit    headings locked and separation steady: the rear rod follows the other's trail
//   escape     the rods part, and what is left of the torques can no longer bring them back
//   undecided  none of these by the end of the run
//
// Criteria, for a pair at the end of the run, with r the separation and r' its rate (v0 = 1):
//   pursuit    |angle between headings| <= 0.1, the rear rod within 0.2 r of the other's axis and behind it,
//   and r
//              varied by at most 5 % of its mean over the last fifth of the run; rods that do not interact
//              cannot pursue each other
//   escape     r' > 0, and in the time r/|n_a - n_b| in which the separation doubles at the present
//   velocities neither
//              heading turns by more than 0.05 rad, at the largest rate of the last fifth of the run
// Of several pairs: contact wins over pursuit, pursuit over undecided; escape means that every pair escapes.

#include "rodwake/integrate/ode.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rodwake::rods {

enum class Ending { contact, pursuit, escape, undecided };

/// The limits above, for those who want others.
struct EndingCriteria {
    double locked_heading = 0.1;     ///< rad
    double lateral_offset = 0.2;     ///< of r
    double steady_separation = 0.05; ///< relative range of r
    double steady_fraction = 0.2;    ///< of the run, its last part
    double residual_turn = 0.05;     ///< rad, while the separation doubles
};

/// What is known of a pair when the run has ended.
struct PairHistory {
    double min_late = 0.0, max_late = 0.0; ///< range of the separation over the last part of the run
    double max_turning = 0.0; ///< largest |theta'| of either rod over that part, mean over a step
};

/// Ending of the pair (a, b) from the final state and its time derivative; never `contact`. In a periodic box
/// of the nearest images (separation.hpp).
Ending classify_pair(integrate::State y, integrate::State ydot, std::size_t a, std::size_t b,
                     const PairHistory& history, const EndingCriteria& criteria = {},
                     std::optional<double> box = {});

std::string to_string(Ending ending);

} // namespace rodwake::rods
