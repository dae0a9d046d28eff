#pragma once
// Where a run begins: beads on a relaxed triangular lattice, in a random packing or where an earlier run left
// them; rods put into any of these, the beads in their way cleared.

#include "rodwake/granular/problem.hpp"
#include "rodwake/granular/state.hpp"

namespace rodwake::granular {

/// A triangular lattice that closes in the periodic box.
struct LatticeFit {
    int m1 = 0, n1 = 0, m2 = 0,
        n2 = 0;               ///< box edges as lattice vectors: L_x x = m1 a1 + n1 a2, L_y y = m2 a1 + n2 a2
    long sites = 0;           ///< |m1 n2 - m2 n1|
    double orientation = 0.0; ///< angle of the a1 rows it really has, rad
    double strain = 0.0;      ///< largest principal stretch from the perfect triangle, minus 1
    double spacing = 0.0;     ///< shortest distance of neighbours, m
};

/// The least strained lattice with at least `sites` sites, rows at about `orientation` (mod 60 degrees).
LatticeFit fit_lattice(const PeriodicBox& box, long sites, double orientation);

/// A rectangle that a perfect triangular lattice fills: `in_row` sites a row, an even number of rows.
struct LatticeBox {
    PeriodicBox box;
    long in_row = 0, rows = 0;
    bool rows_along_y = false;

    long sites() const { return in_row * rows; }
    /// Distance of rows over that of sites in them: sqrt(3)/2 but for rounding.
    double row_ratio() const;
};

/// The numbers of sites and rows, at least `least` sites in all, that are nearest to a square with `sites`:
/// least |ln(L_x/L_y)| + |ln(found/sites)|. `orientation` of the rows is a multiple of 30 degrees: 60 degrees
/// are the same lattice. Throws InputError for another. The box is of area 1.
LatticeBox lattice_box(double sites, long least, double orientation);
/// The same in a box of this area.
LatticeBox with_area(LatticeBox shape, double area);

/// How long a bed takes to settle before it is worth measuring, s: 0.5 s from a lattice, 0 where its beads
/// are given. A random start needs time to order: at phi_b = 0.70 a fluid settles in 2 s, from the transition
/// on (0.72) crystals grow, 8 s, ever slower the denser the bed, 24 s from 0.80 on; between the measured
/// densities it is interpolated.
double settling_time(Start start, double phi_b);

/// State at step 0. Deterministic in (problem, run): beads and velocities from the stream (seed, run).
/// Nothing overlaps: beads with beads, rods or plates. Rods lie flat within 1 % of their free height of mid
/// gap and move upwards at a normal speed of rms start_speed, so that runs differ without beads too; in the
/// plane they rest. Beads are numbered by place: successive numbers are near each other. Given beads keep
/// their order and, if their heights are given too, their places: InputError if they overlap. Throws RunError
/// if no such packing was found.
State make_start(const GranularProblem& problem, std::uint32_t run);

/// State at step 0 with the bed of `stored`: its beads' places in the plane, wrapped into the box, and
/// velocities; problem.start and orientation mean nothing. Beads beyond problem.beads are taken out: those
/// that the rods cover, the deepest first, then others at random (seed, run). Beads start near mid gap,
/// because heights at one phase of the plates mean nothing at another; stored rods are left out, this
/// problem's are as in make_start. Throws InputError if `stored` has too few beads, RunError if the beads do
/// not fit.
State restart_from(const GranularProblem& problem, const State& stored, std::uint32_t run);

} // namespace rodwake::granular
