#include "potential.hpp"

#include "bessel.hpp"

#include <cmath>

namespace rodwake::elastic {

namespace {

/// Derivatives of f(s) from f', f'' and, for order three, f'''.
Derivatives radial(const Geometry& at, double f1, double f2, double f3, Order order) {
    const double c = at.c, q = at.q, s = at.s;
    Derivatives d;
    d.x = c * f1;
    d.y = q * f1;
    d.xx = c * c * f2 + q * q * f1 / s;
    d.yy = q * q * f2 + c * c * f1 / s;
    d.xy = c * q * (f2 - f1 / s);
    if (order == Order::third) {
        const double mixed = (f2 - f1 / s) / s;
        d.xxx = c * (c * c * f3 + 3.0 * q * q * mixed);
        d.xxy = q * (c * c * f3 + (q * q - 2.0 * c * c) * mixed);
        d.xyy = c * (q * q * f3 + (c * c - 2.0 * q * q) * mixed);
        d.yyy = q * (q * q * f3 + 3.0 * c * c * mixed);
    }
    return d;
}

/// What is left of d by lap G = -2 a d_X G, where `full` holds the derivatives of G itself (d may lack a
/// harmonic part).
void complete(Derivatives& d, const Derivatives& full, double a, Order order) {
    d.yy = -d.xx - 2.0 * a * full.x;
    if (order == Order::third) {
        d.xyy = -d.xxx - 2.0 * a * full.xx;
        d.yyy = -d.xxy - 2.0 * a * full.xy;
    }
}

} // namespace

Potential scaled_potential(const Geometry& at, double a, DoubleDouble exponent, Order order) {
    const double z = a * at.s, p = at.p, q = at.q;
    const auto [k0, k1, d1, d2] = scaled_bessel(z);
    const double e = exp_minus(exponent);
    Potential g{e * k0, {}};
    g.d.x = a * e * (d1 - p * k1);
    g.d.y = -a * e * q * k1;
    if (order == Order::first)
        return g;

    const double ratio = d2 + 2.0 * d1, e1 = 2.0 * d2 + 3.0 * d1; // k1/z; k1/z - dk1/dz
    const double xx = p * p * k0 + (1.0 - p) * d2 - p * (3.0 - 2.0 * p) * ratio;
    const double xy = p * k1 + (p - 1.0) * e1;
    g.d.xx = a * a * e * xx;
    g.d.xy = a * a * e * q * xy;
    if (order == Order::third) {
        const double t = 1.0 / z, d3 = e1 * t - 2.0 * d2, e1_slope = d2 - (6.0 * d1 + 4.0 * d2) * t;
        const double turn = p * (2.0 - p) * t; // d_X p over a
        const double xxx = -p * xx + turn * (2.0 * p * k0 - d2 - (3.0 - 4.0 * p) * ratio) +
                           (p - 1.0) * (p * (3.0 - 2.0 * p) * e1 * t - p * p * d1 - (1.0 - p) * d3);
        const double xxy =
            xy * ((1.0 - p) * t - p) + turn * (k1 + e1) + (p - 1.0) * ((p - 1.0) * e1_slope - p * (d1 + d2));
        g.d.xxx = a * a * a * e * xxx;
        g.d.xxy = a * a * a * e * q * xxy;
    }
    complete(g.d, g.d, a, order);
    return g;
}

Potential core_potential(const Geometry& at, double a, Order order) {
    // In Z = a X: G + ln s = e^(-X) (phi - ln s) + ln s with phi = K0 + ln s regular, phi' = -(K1 - 1/s).
    Geometry z = at;
    z.X *= a;
    z.s *= a;
    const auto [k0, kappa1] = core_bessel(z.s);
    const double e = std::exp(-z.X), m = std::expm1(-z.X), s = z.s;
    const double phi2 = k0 + kappa1 / s, phi3 = -(kappa1 + 1.0 / s) - (k0 + 2.0 * kappa1 / s) / s;
    const Derivatives phi = radial(z, -kappa1, phi2, phi3, order);
    const Derivatives log = log_derivatives(z, order);
    const double fx = phi.x - log.x, fy = phi.y - log.y; // derivatives of K0(s)
    Derivatives d;
    d.x = a * (e * (phi.x - k0) - m * log.x);
    d.y = a * (e * phi.y - m * log.y);
    d.xx = a * a * (e * (phi.xx - 2.0 * fx + k0) - m * log.xx);
    d.xy = a * a * (e * (phi.xy - fy) - m * log.xy);
    if (order == Order::third) {
        const double fxx = phi.xx - log.xx, fxy = phi.xy - log.xy;
        d.xxx = a * a * a * (e * (phi.xxx - 3.0 * fxx + 3.0 * fx - k0) - m * log.xxx);
        d.xxy = a * a * a * (e * (phi.xxy - 2.0 * fxy + fy) - m * log.xxy);
    }
    const Derivatives full = {.x = d.x - a * log.x, .xx = d.xx - a * a * log.xx, .xy = d.xy - a * a * log.xy};
    complete(d, full, a, order);
    return {e * k0, d};
}

Derivatives log_derivatives(const Geometry& at, Order order) {
    const double u = 1.0 / at.s;
    return radial(at, u, -u * u, 2.0 * u * u * u, order);
}

} // namespace rodwake::elastic
