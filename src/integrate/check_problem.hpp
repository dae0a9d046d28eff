#pragma once

#include "rodwake/integrate/ode.hpp"

namespace rodwake::integrate {

/// Throws InputError for what solve() cannot start from; the message names the offending value and what is
/// legal.
void check_problem(const OdeProblem& problem, const OdeOptions& options,
                   std::span<const double> output_times);

} // namespace rodwake::integrate
