#pragma once
// What `rodwake check` says of [measure].

#include "check_bed.hpp"
#include "rodwake/granular/problem.hpp"

namespace rodwake::cli {

/// What is and what is not measured. Throws InputError for what cannot be.
std::vector<CheckLine> check_measure(const scene::Scene& scene, const granular::GranularProblem& problem);

} // namespace rodwake::cli
