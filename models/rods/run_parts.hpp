#pragma once
// What runs with and without noise share: what a problem must be, when its states are stored, how a run ends.

#include "rodwake/rods/simulate.hpp"

#include <vector>

namespace rodwake::rods {

/// Throws InputError for an ill-posed problem (simulate.hpp).
void validate(const RodProblem& problem);

/// The times to store: those of the problem, and t_end.
std::vector<double> output_times(const RodProblem& problem);

/// How a run ended, from its last state and what was recorded on the way. A run that an event stopped is in
/// contact.
RodOutcome conclude(const RodProblem& problem, const RodModel& model, const integrate::Solution& solution,
                    SeparationRecord& record, const EndingCriteria& criteria);

/// A solve that fails with two rods nearly in one place failed because their fields are singular there: the
/// status then says so.
void explain_collision(integrate::Solution& solution, Box box);

} // namespace rodwake::rods
