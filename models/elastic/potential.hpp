#pragma once
// The potential G_a = exp(-a X) K0(a s) of the moving source and its derivatives; the whole field is made of
// two of them, a = 1 (shear) and a = nu (longitudinal). G_a solves lap G + 2 a d_X G = 0 away from the
// origin, which gives every second y derivative from the others.

#include "geometry.hpp"

namespace rodwake::elastic {

/// Derivatives by X and Y of a function of the plane (lengths in 2 xi).
struct Derivatives {
    double x = 0, y = 0;
    double xx = 0, xy = 0, yy = 0;
    double xxx = 0, xxy = 0, xyy = 0, yyy = 0;
};

/// How many derivatives are wanted: 1, 2 or 3.
enum class Order { first = 1, second = 2, third = 3 };

/// G_a away from the core: value and derivatives. Relative error of each derivative a few ulp of its largest
/// part, which on the wake axis is the derivative itself.
struct Potential {
    double value;
    Derivatives d;
};
Potential scaled_potential(const Geometry& at, double a, DoubleDouble exponent, Order order);

/// The core, a s <= 1: the derivatives of G_a + ln s, whose difference between two a is free of the 1/s,
/// 1/s^2, 1/s^3 that cancel between them. `value` is G_a itself. d.yy, d.xyy, d.yyy follow from the equation
/// for G_a.
Potential core_potential(const Geometry& at, double a, Order order);

/// Derivatives of ln s.
Derivatives log_derivatives(const Geometry& at, Order order);

} // namespace rodwake::elastic
