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

/// Whether a start ended in the minimum that the fit reports: as low but for rounding, or as low but for 1e-4
/// and in the same place.
bool at_the_best(const Fit& fit, const Report& report, const StartResult& start);

/// "0.02", or "< 1e-300" where doubles end.
std::string describe_probability(double probability);

} // namespace rodwake::fitting
