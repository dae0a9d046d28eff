#pragma once
// How the field of a rod changes with the medium: d/d eta and d/d xi at a fixed place. For fits and for the
// sensitivities of trajectories.
//
//   d/d xi:  U depends on x/xi alone: xi dU/dxi = -(x d_x + y d_y) U, and -(n + x d_x + y d_y) of what has
//            1/xi^n more (strain and dipole 1, polar 2)
//   d/d eta: through c_L = nu c_T alone, nu = 1/(1 + eta); c dG/dc = (x d_x + y d_y) G
//
// Relative error in the vector or tensor norm typically 1e-14, and below 1e-10 at 10000 random points with
// r/xi in [1e-12, 1e8] and eta in [1e-6, 1e6], on and off the axes, wherever the derivative exceeds 1e-290.
// The worst are close to a place where a whole vector nearly vanishes. Two exceptions: the polar vectors on
// the wake axis, 1e-14 nu r/xi, and d/d xi of the dipole on the axis of a soft medium, 1e-13/|1 - nu|.

#include "rodwake/elastic/field.hpp"

namespace rodwake::elastic {

/// Of each, the parts that were asked for: displacement, strain, laplacian, gradient_of_trace, dipole; the
/// rest is NaN. Unit: that of the part, for by_xi per length.
struct MediumDerivatives {
    FieldValues by_eta, by_xi;
};

/// At a point as for Field::at. Gradients are not available: InputError.
MediumDerivatives medium_derivatives(const Field& field, double x, double y, FieldRequest request);

} // namespace rodwake::elastic
