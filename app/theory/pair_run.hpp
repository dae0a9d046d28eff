#pragma once
// How the two rods of a run ended, as numbers; measures/pairs.cpp makes them.

#include "rodwake/app/measure_kind.hpp"
#include "rodwake/core/encounter.hpp"

namespace rodwake::app {

/// As the columns of pairs.csv: lengths in a, angles in rad, times in s.
struct PairNumbers {
    double separation = 0.0;
    double half_box_change = 0.0; ///< NaN: they did not come half a box
    double last_change = 0.0, turn[2] = {}, non_reciprocity = 0.0, min_separation = 0.0, outcome_time = 0.0;
    int leader = 0;
    Ending outcome = Ending::undecided;
};

/// From t = 0 on. Throws InputError where the tracks are none of two rods.
PairNumbers pair_numbers(const scene::Scene& scene, const RunTables& run);

} // namespace rodwake::app
