#include "potential.hpp"

#include "bessel.hpp"

#include <algorithm>
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

} // namespace rodwake::elastic
