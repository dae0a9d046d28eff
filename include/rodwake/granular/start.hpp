#pragma once
// Where a run begins: beads on a relaxed triangular lattice or in a random packing, rods carved into either.

#include "rodwake/granular/problem.hpp"
#include "rodwake/granular/state.hpp"

namespace rodwake::granular {

/// A triangular lattice that closes in the periodic square.
struct LatticeFit {
    int m1 = 0, n1 = 0, m2 = 0, n2 = 0; ///< box edges as lattice vectors: L x = m1 a1 + n1 a2, L y = m2 a1 + n2 a2
    long sites = 0;                     ///< |m1 n2 - m2 n1|
    double orientation = 0.0;           ///< angle of the a1 rows it really has, rad
    double strain = 0.0;                ///< largest principal stretch from the perfect triangle, minus 1
    double spacing = 0.0;               ///< shortest distance of neighbours, m
};

/// The least strained lattice with at least `sites` sites, rows at about `orientation` (mod 60 degrees).
LatticeFit fit_lattice(double box, long sites, double orientation);

/// State at step 0. Deterministic in (problem, run): beads and velocities from the stream (seed, run). Nothing overlaps:
/// beads with beads, rods or plates. Throws RunError if no such packing was found.
State make_start(const GranularProblem& problem, std::uint32_t run);

} // namespace rodwake::granular
