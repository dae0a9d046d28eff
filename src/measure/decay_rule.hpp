#pragma once
// The class that fitted numbers stand for.

#include "rodwake/measure/structure.hpp"

namespace rodwake::measure {

/// Sets decay and reason by the rule in structure.hpp. `zero_chance`: probability of chi2 if g_B were 0;
/// `farthest`: distance of the last point, m.
void decide(DecayClass& c, double zero_chance, double farthest);

} // namespace rodwake::measure
