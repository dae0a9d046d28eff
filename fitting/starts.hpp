#pragma once
// Where the searches begin.

#include "rodwake/fitting/method.hpp"
#include "rodwake/fitting/problem.hpp"

namespace rodwake::fitting {

/// Values of the free parameters for start `index`, as Method::spread says; depends on the seed and index
/// only.
std::vector<double> start_values(const Problem& problem, const Method& method, std::size_t index);

} // namespace rodwake::fitting
