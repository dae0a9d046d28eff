#pragma once
// The combinations of the two potentials G_T and G_L, D = G_T - G_L, that the field is made of. Lengths in 2
// xi.

#include "potential.hpp"

namespace rodwake::elastic {

struct Combination {
    double drift, y;       ///< 2 G_T + d_X D, d_Y D: twice the displacement
    double trace;          ///< nu d_X G_L: div U
    double yy;             ///< d_YY D
    double shear;          ///< d_Y G_T + d_XY D
    double dipole;         ///< d_XY D/2 - nu d_Y G_L
    Vector trace_gradient; ///< nu grad d_X G_L
    Vector laplacian;      ///< nu grad d_X G_L + rotated gradient of the curl: (d_YY, -d_XY) G_T
};

/// Of the two potentials and their differences.
Combination combine(const Geometry& at, const Constants& medium, const Potentials& g, bool core);

/// What the core potentials lack, worked out before it can cancel.
void add_singular(Combination& sum, const Geometry& at, const Constants& medium);

/// Derivatives by X and Y of the combinations.
struct CombinationGradients {
    double yy_x, yy_y, trace_x, trace_y, shear_x, shear_y;
    Vector trace_gradient_x, trace_gradient_y, laplacian_x, laplacian_y;
};
CombinationGradients gradients(const Geometry& at, const Constants& medium, const Potentials& g, bool core);

} // namespace rodwake::elastic
