#pragma once
// How the two rods of a run ended, from what the run wrote.

#include "rodwake/assembly/measure_kind.hpp"
#include "rodwake/measure/pairs.hpp"

namespace rodwake::assembly {

/// Centres nearer than this are in contact: measure.contact_distance, or half the longer rod. m.
double contact_distance(const scene::Scene& scene);

/// From t = 0 on. Throws InputError where the tracks are none of two rods.
measure::PairRun pair_run(const scene::Scene& scene, const RunTables& run);

} // namespace rodwake::assembly
