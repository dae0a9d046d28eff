#include "potential.hpp"

#include "bessel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::elastic {

namespace {

/// The Bessel functions of one a and the exponential they are to be multiplied by.
struct Lane {
    Bessel k;
    double e;
};

Lane lane(const Geometry& at, const WaveNumber& wave) {
    const double a = wave.a.high, z = a * at.s;
    if (z > series_end)
        return {scaled_bessel(at.inverse * wave.inverse, at.root * wave.inverse_root),
                exp_minus(times(wave.a, at.w), at.boost)};
    return {plain_bessel(z), at.boost * std::exp(-a * at.X)};
}

void add_third(Derivatives& d, const Geometry& at, Pair t, Pair k0, Pair k1, Pair d1, Pair d2, Pair scale) {
    const double p = at.p, q = at.q, qq = at.p * at.n;
    const Pair ratio = d2 + 2.0 * d1, k2 = k0 + 2.0 * ratio, step = 2.0 * ratio - d1; // k2 - k1
    const Pair k2_t = k2 * t, k3 = k1 + 4.0 * k2_t;
    d.xyy = scale * (qq * (4.0 * k2_t - step) - step * t + p * (k2_t - qq * k3));
    d.yyy = scale * q * (3.0 * k2_t - qq * k3);
    const Pair e1 = 2.0 * d2 + 3.0 * d1, d3 = e1 * t - 2.0 * d2, e1_slope = d2 - (6.0 * d1 + 4.0 * d2) * t;
    const Pair xx = p * p * k0 + (1.0 - p) * d2 - p * (3.0 - 2.0 * p) * ratio, xy = p * k1 + (p - 1.0) * e1;
    const Pair turn = qq * t; // d_X p over a
    d.xxx = scale * (turn * (2.0 * p * k0 - d2 - (3.0 - 4.0 * p) * ratio) - p * xx +
                     (p - 1.0) * (p * (3.0 - 2.0 * p) * e1 * t - p * p * d1 - (1.0 - p) * d3));
    d.xxy =
        scale * q *
        (xy * ((1.0 - p) * t - p) + turn * (k1 + e1) + (p - 1.0) * ((p - 1.0) * e1_slope - p * (d1 + d2)));
}

} // namespace

Potentials scaled_potentials(const Geometry& at, const WaveNumber& a0, const WaveNumber& a1, Order order) {
    const auto [f, e_f] = lane(at, a0);
    const auto [g, e_g] = lane(at, a1);
    const Pair a{a0.a.high, a1.a.high}, first = a * Pair{e_f, e_g};
    const Pair k0{f.k0, g.k0}, k1{f.k1, g.k1}, d1{f.d1, g.d1}, d2{f.d2, g.d2};
    const double p = at.p, q = at.q;
    Potentials result;
    Derivatives& d = result.d;
    result.drift = first * (at.n * k1 - d1);
    d.x = first * (d1 - p * k1);
    d.y = -first * (q * k1);
    if (order == Order::first) {
        d.xx = d.xy = d.yy =
            Pair{}; // combined like the others, to no use: what is on the stack may be subnormal
        return result;
    }

    const Pair ratio = d2 + 2.0 * d1, e1 = 2.0 * d2 + 3.0 * d1, second = a * first; // k1/z; k1/z - dk1/dz
    d.xx = second * (p * p * k0 + (1.0 - p) * d2 - p * (3.0 - 2.0 * p) * ratio);
    d.xy = second * (q * (p * k1 + (p - 1.0) * e1));
    d.yy = second * (p * at.n * (k0 + 2.0 * ratio) - ratio);
    if (order == Order::third)
        add_third(d, at, at.inverse * Pair{a0.inverse, a1.inverse}, k0, k1, d1, d2, a * second);
    return result;
}

bool in_core(const Geometry& at, double largest_a) { return at.s * std::max(1.0, largest_a) <= series_end; }

Potentials potentials(const Geometry& at, const WaveNumber& a0, const WaveNumber& a1, bool core,
                      Order order) {
    return core ? core_potentials(at, a0, a1, order) : scaled_potentials(at, a0, a1, order);
}

// The potentials where both arguments are small and their singular parts would cancel between them.

namespace {

/// exp(-X) - 1 + X for |X| <= series_end, by its series.
Pair exp_remainder(Pair X) {
    constexpr int terms = 14; // next: 0.5^14/(16!/2) = 6e-18
    constexpr auto coefficient = [] {
        std::array<double, terms> c{};
        double factorial = 1.0;
        for (int k = 0; k < terms; ++k) {
            factorial *= k + 2;
            c[k] = (k % 2 == 0 ? 1.0 : -1.0) / factorial;
        }
        return c;
    }();
    const Pair X2 = X * X;
    Pair even = X2 * 0.0, odd = even;
    for (int k = terms - 2; k >= 0; k -= 2) {
        even = even * X2 + coefficient[k];
        odd = odd * X2 + coefficient[k + 1];
    }
    return X2 * (even + X * odd);
}

/// Derivatives of the radial function phi = K0(s) + ln s, u = 1/s.
Derivatives regular_part(const Geometry& at, Pair u, const CoreBessel& k, Order order) {
    const double c = at.c, q = at.q;
    const Pair f1 = -k.kappa1, f1_u = f1 * u, f2 = k.k0 - f1_u;
    Derivatives d{};
    d.x = c * f1;
    d.y = q * f1;
    d.xx = c * c * f2 + q * q * f1_u;
    d.yy = q * q * f2 + c * c * f1_u;
    d.xy = c * q * (f2 - f1_u);
    if (order == Order::third) {
        const Pair f3 = f1 - u - (k.k0 - 2.0 * f1_u) * u, mixed = (f2 - f1_u) * u;
        d.xxx = c * (c * c * f3 + 3.0 * q * q * mixed);
        d.xxy = q * (c * c * f3 + (q * q - 2.0 * c * c) * mixed);
        d.xyy = c * (q * q * f3 + (c * c - 2.0 * q * q) * mixed);
        d.yyy = q * (q * q * f3 + 3.0 * c * c * mixed);
    }
    return d;
}

/// Derivatives of ln s: the real part of the powers of 1/(X + iY).
Derivatives log_part(const Geometry& at, Pair u) {
    const double c = at.c, q = at.q;
    Derivatives d{};
    d.x = c * u;
    d.y = q * u;
    d.xx = (q * q - c * c) * u * u;
    d.xy = -2.0 * c * q * u * u;
    d.xxx = 2.0 * c * (c * c - 3.0 * q * q) * u * u * u;
    d.xxy = 2.0 * q * (3.0 * c * c - q * q) * u * u * u;
    return d;
}

} // namespace

// In Z = a X: G = e (phi - L), e = exp(-Z), L = ln; with m = e - 1 and m2 = e - 1 + Z the singular parts that
// stay are G + L = e phi - m L, and of second order G + L - Z L.
Potentials core_potentials(const Geometry& at, const WaveNumber& a0, const WaveNumber& a1, Order order) {
    const Pair a{a0.a.high, a1.a.high}, u = at.inverse * Pair{a0.inverse, a1.inverse};
    const Pair Z = a * at.X, s = a * at.s;
    const CoreBessel k = core_bessel(s, Pair{std::log(0.5 * s[0]), std::log(0.5 * s[1])});
    const Pair m2 = exp_remainder(Z), m = m2 - Z, e = 1.0 + m;
    const Derivatives phi = regular_part(at, u, k, order), log = log_part(at, u);
    Potentials result;
    Derivatives& d = result.d;
    d.x = a * (e * (phi.x - k.k0) - m * log.x);
    d.y = a * (e * phi.y - m * log.y);
    result.drift = 2.0 * a * e * k.k0 + d.x;
    const Pair aa = a * a, aaa = aa * a;
    d.xx = aa * (e * (phi.xx - 2.0 * phi.x + k.k0) + 2.0 * m * log.x - m2 * log.xx);
    d.xy = aa * (e * (phi.xy - phi.y) + m * log.y - m2 * log.xy);
    d.yy = aa * (e * phi.yy + m2 * log.xx);
    if (order == Order::third) {
        d.xxx =
            aaa * (e * (phi.xxx - 3.0 * (phi.xx - phi.x + log.x) - k.k0) + 3.0 * m * log.xx - m2 * log.xxx);
        d.xxy = aaa * (e * (phi.xxy - 2.0 * phi.xy + phi.y - log.y) + 2.0 * m * log.xy - m2 * log.xxy);
        d.xyy = aaa * (e * (phi.xyy - phi.yy) - m * log.xx + m2 * log.xxx);
        d.yyy = aaa * (e * phi.yyy + m2 * log.xxy);
    }
    return result;
}

} // namespace rodwake::elastic
