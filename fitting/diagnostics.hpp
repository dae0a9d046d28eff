#pragma once
// What a report says in sentences.

#include "curvature.hpp"

namespace rodwake::fitting {

/// Exactly flat and nearly flat directions (relative singular value below 1e-3).
std::vector<FlatDirection> flat_directions(const Problem& problem, const Fit& fit, const SearchSpace& space,
                                           const Curvature& curvature);

/// `rise`: of the objective, that belongs to one standard error. `exact`: a full step would change no digit
/// that counts.
std::vector<std::string> diagnostics_of(const Problem& problem, const Fit& fit, const Report& report,
                                        double rise, bool exact);

/// "0.02", or "< 1e-300" where doubles end.
std::string describe_probability(double probability);

} // namespace rodwake::fitting
