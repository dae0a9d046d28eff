#pragma once
// The estimator `density`: rho_0(r) = rho(r + U(r)) by the Fourier content at G_k, in a window around r, of
// the time-averaged density in the rod's frame.
//
// The window is a Gaussian of standard deviation 0.75 lattice spacings. It must be that wide: the mean
// density, which has no phase, leaks into the content at G_k by exp(-(G s)^2/2), here 1e-6; within a bin
// alone it would look like a lattice that belongs to the grid. Its price is that U is blurred over the
// window.

#include "rodwake/measure/displacement.hpp"

#include "block_sums.hpp"

#include "rodwake/measure/rod_grid.hpp"

#include <vector>

namespace rodwake::measure {

/// The block's sums (PhaseRecord's channels) in the window around each bin's middle, the far field's phases
/// taken off.
std::vector<double> windowed_density(const BlockSums& block, const RodGrid& grid, double lattice_spacing,
                                     double far_from);

} // namespace rodwake::measure
