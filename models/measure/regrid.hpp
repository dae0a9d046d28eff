#pragma once
// From samples at scattered places to the middles of the bins.
//
// A bin's mean displacement belongs to the mean place of its beads, taken back by that displacement: so U at
// the undisplaced place needs no inversion, only that the samples' undisplaced places do not change order,
// which they keep while the gradients of U are below 1. A middle's value is the mean, weighted by beads, of
// the samples within half a spacing of it (else of the nearest, within 0.75), each moved by the difference of
// a local quadratic fit through its neighbourhood between its place and the middle. So each sample stands
// behind one value, hardly more, and errors of neighbours stay independent.

#include "estimators.hpp"

#include <cstddef>
#include <vector>

namespace rodwake::measure {

/// Overwrites the parts of `field` that belong to bins; count 0 and value 0 where there is no sample.
/// `undisplaced` are the samples' places.
void regrid(const BinSamples& samples, const std::vector<Vector2>& undisplaced, DisplacementField& field);

// Values of empty bins from those around them.

/// Solves the discrete Laplace equation in the bins of a grid of so many columns that are not known, with the
/// known ones as given and no flux through the edge. All stay as they are if none is known.
void fill_in(std::vector<double>& values, const std::vector<bool>& known, std::size_t columns);

} // namespace rodwake::measure
