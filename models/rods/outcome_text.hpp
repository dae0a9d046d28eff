#pragma once
// Sentences that describe the outcome of a run.

#include "rodwake/rods/simulate.hpp"

namespace rodwake::rods {

/// Sets outcome.reason from the rest of it.
void describe(RodOutcome& outcome, std::size_t rods, const integrate::Status& status);

} // namespace rodwake::rods
