#pragma once
// The combinations of the two potentials G_T and G_L, D = G_T - G_L, that the field is made of. Lengths in 2
// xi.

#include "bessel.hpp"
#include "geometry.hpp"

namespace rodwake::elastic {

// The potential G_a = exp(-a X) K0(a s) of the moving source and its derivatives; the whole field is made of
// two of them, a = 1 (shear) and a = nu (longitudinal). Each Pair holds two values of a.

/// Derivatives by X and Y of a function of the plane (lengths in 2 xi).
struct Derivatives {
    Pair x, y;
    Pair xx, xy, yy;
    Pair xxx, xxy, xyy, yyy;
};

/// How many derivatives are wanted.
enum class Order { first = 1, second = 2, third = 3 };

/// Two potentials at one point. In the core `d` lacks the singular parts of add_singular (combination.hpp).
struct Potentials {
    Pair drift; ///< 2 a G_a + d_X G_a, the x displacement a shear potential makes; small on the axis ahead
    Derivatives d;
};

/// Away from the core. Relative error of each derivative a few ulp of its largest part, which on the axis is
/// the derivative itself, ahead and behind.
Potentials scaled_potentials(const Geometry& at, const WaveNumber& a0, const WaveNumber& a1, Order order);

/// The core, a s <= series_end: first derivatives of G_a + ln s, higher ones of G_a + (1 - a X) ln s. What is
/// left grows like ln s and no faster, third derivatives like ln(s)/s.
Potentials core_potentials(const Geometry& at, const WaveNumber& a0, const WaveNumber& a1, Order order);

/// Both by the rule above: core if both a s <= series_end.
bool in_core(const Geometry& at, double largest_a);
Potentials potentials(const Geometry& at, const WaveNumber& a0, const WaveNumber& a1, bool core, Order order);

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

inline Vector times(double scale, Vector v) { return {scale * v.x, scale * v.y}; }

} // namespace rodwake::elastic
