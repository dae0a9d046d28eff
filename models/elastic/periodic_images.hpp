#pragma once
// Near the rod, for wave numbers c of 6 over the box and more: the infinite plane's potentials of the images
// in the rod's own column, exp(-c.r) K0(c r) each. Unit of length: the box's side.

#include "periodic_jet.hpp"

namespace rodwake::elastic {

/// One source at the origin, heading (ux, uy); c r > 0.5.
void add_source(Jets& sum, double c, double ux, double uy, double x, double y, Needed needed);

/// Those at (0, j), j != 0, as far as they exceed e^-40; |ux| >= |uy|, so that none lies in the wake of all.
void add_column_images(Jets& sum, double c, double ux, double uy, double x, double y, Needed needed);

} // namespace rodwake::elastic
