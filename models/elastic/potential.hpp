#pragma once
// The potential G_a = exp(-a X) K0(a s) of the moving source and its derivatives; the whole field is made of
// two of them, a = 1 (shear) and a = nu (longitudinal). Each Pair holds two values of a.

#include "bessel.hpp"
#include "geometry.hpp"

namespace rodwake::elastic {

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

} // namespace rodwake::elastic
