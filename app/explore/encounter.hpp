#pragma once
// Encounters of rods with their whole path, and the wakes of rods at many points: what the page of `rodwake
// explore` computes in a browser. Free of SUNDIALS, threads and files, so that it compiles to WebAssembly
// (wasm.cpp); built into the program's library too, where it is tested.
//
// Two rods go through the kernels of rods/pair_batch.hpp. Another number of rods, and pairs that these hand
// over, are integrated by Dormand-Prince 5(4) (the same tolerances, step limit, endings)
// from the equations of rods/model.hpp. Reduced units, infinite plane.
//
// Error: of states at most 1e-6 from rods::simulate at rtol 1e-8, but for rods that nearly meet
// (studies/validate_explorer.py).
//
// Degenerate input: as rods::simulate; rods that pass through each other without a contact distance, and
// pairs too stiff for an explicit method, throw RunError.

#include "rodwake/elastic/wake_kernel.hpp"
#include "rodwake/rods/simulate.hpp"

#include <span>
#include <vector>

namespace rodwake::app {

/// Rows of time, then x, y, theta of each rod, then theta' of each rod: at the start and the end of every
/// step.
struct EncounterPath {
    rods::RodOutcome outcome;
    std::size_t rods = 0;
    std::vector<double> rows;
};

/// problem: medium, couplings, rods, t_end and contact_distance count. Throws InputError, RunError.
EncounterPath encounter(const rods::RodProblem& problem, double rtol);

/// How each pair ends, by the kernels; handed-over pairs by encounter(). A pair that fails is undecided at
/// time NaN.
struct EncounterSummary {
    Ending ending = Ending::undecided;
    double time = 0.0, min_separation = 0.0;
    double turn[2] = {}; ///< rad
};
void encounters(std::span<const rods::RodProblem> problems, double rtol, std::span<EncounterSummary> ends);

/// Columns of numbers, as long as the points. Displacement costs ten times the rest: empty, not computed.
struct WakeColumns {
    elastic::StrainSums strain;
    elastic::PolarSums polar;
    std::span<double> displacement_x, displacement_y; ///< f/mu
};

/// Sums of the rods' wakes. At a rod itself NaN.
void wakes(const elastic::Medium& medium, std::span<const elastic::Source> rods, elastic::FieldPoints points,
           const WakeColumns& columns);

} // namespace rodwake::app
