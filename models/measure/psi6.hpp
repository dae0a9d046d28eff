#pragma once
// psi_6 of each bead with the number of its neighbours, by either rule for who is one.

#include "rodwake/core/bond_order.hpp"

#include <span>
#include <vector>

namespace rodwake::measure {

/// Places in the box, else InputError; 0 < cutoff <= half its shorter side.
LocalOrder order_by_cutoff(const std::vector<double>& x, const std::vector<double>& y, const PeriodicBox& box,
                           double cutoff);
LocalOrder order_by_delaunay(const std::vector<double>& x, const std::vector<double>& y,
                             const PeriodicBox& box);

/// Mean over the neighbours, by g(r) up to the cut-off, of what is left of exp(6 i theta) if every coordinate
/// has this standard error (order.hpp).
double bond_loss(std::span<const double> r, std::span<const double> g, double cutoff, double localisation);

// Delaunay neighbours in the periodic box, also of a bead to its own image: around each bead the empty
// circles are followed from the nearest neighbour on. Only beads within some reach are looked at; it grows
// until all circles lie within it, which proves them empty.
//
// Where four or more beads lie on one empty circle (square lattice) the triangulation is not unique, and
// rounding would choose. So neighbours must have a common Voronoi edge of at least 1e-7 box: beads across
// such a circle are none, and each bead of a square lattice has four. Beads in exactly one place do not see
// each other.

/// Places in the box.
std::vector<Bond> delaunay_bonds(const std::vector<double>& x, const std::vector<double>& y,
                                 const PeriodicBox& box);

} // namespace rodwake::measure
