#include "combination.hpp"

#include "bessel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::elastic {

namespace {

double difference(Pair both) { return both[0] - both[1]; }

/// Derivatives of D.
struct Difference {
    double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
};

WaveNumber wave_number(double a) { return {{a, 0.0}, 1.0 / a, std::sqrt(1.0 / a)}; }

/// D for nearly equal potentials as the integral of dG_a/da from nu to 1 (4-point Gauss-Legendre, two nodes
/// at a time): direct subtraction would lose 1/|1 - nu|. By homogeneity a dG_a/da = (X d_X + Y d_Y) G_a.
Difference difference_by_integral(const Geometry& at, const Constants& medium, bool core) {
    constexpr double node[] = {0.069431844202973712, 0.33000947820757187};
    constexpr double weight[] = {0.17392742256872693, 0.32607257743127307};
    const auto sum_of = [](Pair both) { return both[0] + both[1]; };
    Difference sum;
    if (core) // second derivatives there lack those of a X ln s, on whose d_X the operator gives a
        sum.x = medium.delta;
    for (int k = 0; k < 2; ++k) {
        const double a0 = 1.0 - node[k] * medium.delta, a1 = 1.0 - (1.0 - node[k]) * medium.delta;
        const Pair part = weight[k] * medium.delta / Pair{a0, a1};
        const Derivatives d = potentials(at, wave_number(a0), wave_number(a1), core, Order::third).d;
        sum.x += sum_of(part * (d.x + at.X * d.xx + at.Y * d.xy));
        sum.y += sum_of(part * (d.y + at.X * d.xy + at.Y * d.yy));
        sum.xx += sum_of(part * (2.0 * d.xx + at.X * d.xxx + at.Y * d.xxy));
        sum.xy += sum_of(part * (2.0 * d.xy + at.X * d.xxy + at.Y * d.xyy));
        sum.yy += sum_of(part * (2.0 * d.yy + at.X * d.xyy + at.Y * d.yyy));
    }
    return sum;
}

} // namespace

Combination combine(const Geometry& at, const Constants& medium, const Potentials& g, bool core) {
    const Derivatives& d = g.d;
    const double nu = medium.nu, t_x = d.x[0], l_xx = d.xx[1], l_xy = d.xy[1];
    Combination sum;
    sum.trace = nu * d.x[1];
    sum.trace_gradient = {nu * l_xx, nu * l_xy};
    if (std::abs(medium.delta) * (2.0 + at.w.high) <= 0.05) {
        const Difference D = difference_by_integral(at, medium, core);
        sum.drift = (g.drift[0] - t_x) + D.x;
        sum.y = D.y;
        sum.yy = D.yy;
        sum.shear = d.y[0] + D.xy;
        sum.dipole = 0.5 * D.xy - nu * d.y[1];
        sum.laplacian = {-2.0 * t_x - (D.xx + medium.delta * l_xx), -(D.xy + medium.delta * l_xy)};
        return sum;
    }
    sum.drift = g.drift[0] - d.x[1];
    sum.y = difference(d.y);
    sum.yy = difference(d.yy);
    sum.shear = d.y[0] + difference(d.xy);
    sum.dipole = 0.5 * difference(d.xy) - nu * d.y[1];
    sum.laplacian = {d.yy[0] + nu * l_xx, nu * l_xy - d.xy[0]};
    return sum;
}

// The singular parts of the combinations at the rod: those of -ln s + a X ln s, which the core potentials
// lack. Summed between the two potentials on paper, so that what cancels there (all of it for nu = 1, the
// shear beside the rod and the dipole on the diagonals for nu -> 0) is gone before rounding.

namespace {

/// Below this part of its largest term the sum has lost two digits.
constexpr double cancels = 1e-2;

} // namespace

void add_singular(Combination& sum, const Geometry& at, const Constants& medium) {
    const double nu = medium.nu, delta = medium.delta, u = at.inverse, c = at.c, q = at.q;
    const double h = (at.Y - at.X) * (at.Y + at.X) * u * u; // -cos of twice the angle, exact on the diagonals
    const double k_xx = c * u * (2.0 + h), k_xy = q * h * u, k_yy = -c * h * u; // of X ln s
    const double l_xx = h * u * u, l_xy = -2.0 * c * q * u * u;                 // of ln s
    const double one_less_nu_squared = delta * (1.0 + nu);
    sum.trace -= nu * c * u;
    sum.yy += delta * k_yy;
    sum.shear -= (nu + 2.0 * delta * c * c) * q * u;
    sum.dipole += (0.5 * delta * h + nu) * q * u;
    sum.trace_gradient.x += nu * (nu * k_xx - l_xx);
    sum.trace_gradient.y += nu * (nu * k_xy - l_xy);
    sum.laplacian.y += delta * l_xy - one_less_nu_squared * k_xy;
    const double laplacian_x = delta * l_xx + one_less_nu_squared * k_yy + 2.0 * nu * nu * c * u;
    if (!(std::abs(laplacian_x) < cancels * std::abs(delta * l_xx))) {
        sum.laplacian.x += laplacian_x;
        return;
    }

    // To twice the precision, as its two terms cancel: it is (2 xi/r^2) [2 xi delta h + x (2 nu^2 - (1 -
    // nu^2) h)], h = (y^2 - x^2)/r^2, over 4 xi^2. On the axis ahead that happens at r = 2 delta xi/(1 +
    // nu^2), near eta xi.
    const DoubleDouble xx = exact_product(at.x, at.x), yy = exact_product(at.y, at.y), square = add(xx, yy);
    const DoubleDouble h2 = divide(add(yy, DoubleDouble{-xx.high, -xx.low}), square);
    const DoubleDouble nu2{medium.nu, medium.nu_low}, nu_squared = multiply(nu2, nu2);
    const DoubleDouble delta2 = add(exact_sum(1.0, -medium.nu), -medium.nu_low);
    const DoubleDouble rest = multiply(delta2, add(nu2, 1.0)); // 1 - nu^2
    const DoubleDouble rest_h = multiply(rest, h2), two_xi{medium.two_xi, 0.0};
    const DoubleDouble turning = add(DoubleDouble{2.0 * nu_squared.high, 2.0 * nu_squared.low},
                                     DoubleDouble{-rest_h.high, -rest_h.low});
    const DoubleDouble bracket = add(multiply(two_xi, multiply(delta2, h2)), multiply({at.x, 0.0}, turning));
    sum.laplacian.x += divide(multiply(two_xi, bracket), square).high;
}

// Derivatives of the combinations: third derivatives of the two potentials.

CombinationGradients gradients(const Geometry& at, const Constants& medium, const Potentials& g, bool core) {
    const double nu = medium.nu;
    const auto t = [](Pair both) { return both[0]; };
    const auto l = [nu](Pair both) { return nu * both[1]; };
    const Derivatives& d = g.d;
    CombinationGradients sum{.yy_x = difference(d.xyy),
                             .yy_y = difference(d.yyy),
                             .trace_x = l(d.xx),
                             .trace_y = l(d.xy),
                             .shear_x = t(d.xy) + difference(d.xxy),
                             .shear_y = t(d.yy) + difference(d.xyy),
                             .trace_gradient_x = {l(d.xxx), l(d.xxy)},
                             .trace_gradient_y = {l(d.xxy), l(d.xyy)},
                             .laplacian_x = {t(d.xyy) + l(d.xxx), l(d.xxy) - t(d.xxy)},
                             .laplacian_y = {t(d.yyy) + l(d.xxy), l(d.xyy) - t(d.xyy)}};
    if (!core)
        return sum;

    // Derivatives of ln s (l; l_yy = -l_xx, l_xyy = -l_xxx, l_yyy = -l_xxy) and of X ln s (k).
    const double u = at.inverse, uu = u * u, X = at.X, c = at.c, q = at.q, h = q * q - c * c;
    const double l_xx = h * uu, l_xy = -2.0 * c * q * uu;
    const double l_xxx = 2.0 * c * (c * c - 3.0 * q * q) * uu * u,
                 l_xxy = 2.0 * q * (3.0 * c * c - q * q) * uu * u;
    const double k_xx = 2.0 * c * u + X * l_xx, k_xy = q * u + X * l_xy, k_yy = -X * l_xx;
    const double k_xxx = 3.0 * l_xx + X * l_xxx, k_xxy = 2.0 * l_xy + X * l_xxy, k_xyy = -l_xx - X * l_xxx,
                 k_yyy = -X * l_xxy;

    const double delta = medium.delta, one_less_nu_squared = delta * (1.0 + nu);
    sum.yy_x += delta * k_xyy;
    sum.yy_y += delta * k_yyy;
    sum.trace_x += nu * (nu * k_xx - l_xx);
    sum.trace_y += nu * (nu * k_xy - l_xy);
    sum.shear_x += (k_xy - l_xy) + delta * k_xxy;
    sum.shear_y += (k_yy + l_xx) + delta * k_xyy;
    const Vector trace{nu * (nu * k_xxx - l_xxx), nu * (nu * k_xxy - l_xxy)};
    sum.trace_gradient_x.x += trace.x;
    sum.trace_gradient_x.y += trace.y;
    sum.trace_gradient_y.x += trace.y;
    sum.trace_gradient_y.y += nu * (nu * k_xyy + l_xxx);
    sum.laplacian_x.x += delta * l_xxx + k_xyy + nu * nu * k_xxx;
    sum.laplacian_y.x += delta * l_xxy + k_yyy + nu * nu * k_xxy;
    sum.laplacian_x.y += delta * l_xxy - one_less_nu_squared * k_xxy;
    sum.laplacian_y.y -= delta * l_xxx + one_less_nu_squared * k_xyy;
    return sum;
}

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
    if (order != Order::third)
        return result;

    const double qq = at.p * at.n;
    const Pair t = at.inverse * Pair{a0.inverse, a1.inverse}, third = a * second;
    const Pair k2 = k0 + 2.0 * ratio, step = 2.0 * ratio - d1; // k2 - k1
    const Pair k2_t = k2 * t, k3 = k1 + 4.0 * k2_t;
    d.xyy = third * (qq * (4.0 * k2_t - step) - step * t + p * (k2_t - qq * k3));
    d.yyy = third * q * (3.0 * k2_t - qq * k3);
    const Pair d3 = e1 * t - 2.0 * d2, e1_slope = d2 - (6.0 * d1 + 4.0 * d2) * t;
    const Pair xx = p * p * k0 + (1.0 - p) * d2 - p * (3.0 - 2.0 * p) * ratio, xy = p * k1 + (p - 1.0) * e1;
    const Pair turn = qq * t; // d_X p over a
    d.xxx = third * (turn * (2.0 * p * k0 - d2 - (3.0 - 4.0 * p) * ratio) - p * xx +
                     (p - 1.0) * (p * (3.0 - 2.0 * p) * e1 * t - p * p * d1 - (1.0 - p) * d3));
    d.xxy =
        third * q *
        (xy * ((1.0 - p) * t - p) + turn * (k1 + e1) + (p - 1.0) * ((p - 1.0) * e1_slope - p * (d1 + d2)));
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
