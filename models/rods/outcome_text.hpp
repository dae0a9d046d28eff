#pragma once
// How a run's outcome is told in words.

#include "rodwake/rods/simulate.hpp"

namespace rodwake::rods {

/// Sets outcome.reason from the rest of it.
void describe(RodOutcome& outcome, std::size_t rods, const integrate::Status& status);

} // namespace rodwake::rods
