#pragma once
// What a method must fulfil for a problem.

#include "rodwake/fitting/method.hpp"
#include "rodwake/fitting/problem.hpp"

namespace rodwake::fitting {

/// Throws InputError: values out of range, a global search without bounds, finished starts of another fit.
void check_method(const Problem& problem, const Method& method);

} // namespace rodwake::fitting
