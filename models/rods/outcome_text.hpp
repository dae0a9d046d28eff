#pragma once
// Sentences that describe the outcome of a run.

#include "rodwake/rods/simulate.hpp"

namespace rodwake::rods {

/// What an undecided pair (a, b) fails, "rods 0 and 1 show no pursuit (...), no escape (...)"; arguments as
/// of classify_pair.
std::string failed_criteria(integrate::State y, integrate::State ydot, std::size_t a, std::size_t b,
                            const TailWindow& late, const EndingCriteria& criteria, Box box = {});

/// Sets outcome.reason from the rest of it.
void describe(RodOutcome& outcome, std::size_t rods, const integrate::Status& status);

} // namespace rodwake::rods
