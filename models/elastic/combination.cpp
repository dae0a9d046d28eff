#include "combination.hpp"

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

/// The integrand varies as exp(-a w) and as a power of a: the rule is exact to 1e-16 below this bound, and
/// beyond it subtraction loses a factor 20 at most.
bool nearly_equal(const Geometry& at, const Constants& medium) {
    return std::abs(medium.delta) * (2.0 + at.w.high) <= 0.05;
}

} // namespace

Combination combine(const Geometry& at, const Constants& medium, const Potentials& g, bool core) {
    const Derivatives& d = g.d;
    const double nu = medium.nu, t_x = d.x[0], l_xx = d.xx[1], l_xy = d.xy[1];
    Combination sum;
    sum.trace = nu * d.x[1];
    sum.trace_gradient = {nu * l_xx, nu * l_xy};
    if (nearly_equal(at, medium)) {
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

/// Singular part of the laplacian's x component to twice the precision, for points where its two terms
/// cancel: it is (2 xi/r^2) [2 xi delta h + x (2 nu^2 - (1 - nu^2) h)], h = (y^2 - x^2)/r^2, over 4 xi^2. On
/// the axis ahead that happens at r = 2 delta xi/(1 + nu^2), near eta xi.
double precise_laplacian_x(const Geometry& at, const Constants& medium) {
    const DoubleDouble xx = exact_product(at.x, at.x), yy = exact_product(at.y, at.y), square = add(xx, yy);
    const DoubleDouble h = divide(add(yy, DoubleDouble{-xx.high, -xx.low}), square);
    const DoubleDouble nu{medium.nu, medium.nu_low}, nu_squared = multiply(nu, nu);
    const DoubleDouble delta = add(exact_sum(1.0, -medium.nu), -medium.nu_low);
    const DoubleDouble rest = multiply(delta, add(nu, 1.0)); // 1 - nu^2
    const DoubleDouble rest_h = multiply(rest, h), two_xi{medium.two_xi, 0.0};
    const DoubleDouble turning = add(DoubleDouble{2.0 * nu_squared.high, 2.0 * nu_squared.low},
                                     DoubleDouble{-rest_h.high, -rest_h.low});
    const DoubleDouble bracket = add(multiply(two_xi, multiply(delta, h)), multiply({at.x, 0.0}, turning));
    const DoubleDouble sum = divide(multiply(two_xi, bracket), square);
    return sum.high;
}

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
    const double laplacian_x = delta * l_xx + one_less_nu_squared * k_yy + 2.0 * nu * nu * c * u;
    sum.laplacian.x += std::abs(laplacian_x) < cancels * std::abs(delta * l_xx)
                           ? precise_laplacian_x(at, medium)
                           : laplacian_x;
    sum.laplacian.y += delta * l_xy - one_less_nu_squared * k_xy;
}

// Derivatives of the combinations: third derivatives of the two potentials.

namespace {

CombinationGradients regular(const Constants& medium, const Potentials& g) {
    const double nu = medium.nu;
    const auto t = [](Pair both) { return both[0]; };
    const auto l = [nu](Pair both) { return nu * both[1]; };
    const Derivatives& d = g.d;
    return {.yy_x = difference(d.xyy),
            .yy_y = difference(d.yyy),
            .trace_x = l(d.xx),
            .trace_y = l(d.xy),
            .shear_x = t(d.xy) + difference(d.xxy),
            .shear_y = t(d.yy) + difference(d.xyy),
            .trace_gradient_x = {l(d.xxx), l(d.xxy)},
            .trace_gradient_y = {l(d.xxy), l(d.xyy)},
            .laplacian_x = {t(d.xyy) + l(d.xxx), l(d.xxy) - t(d.xxy)},
            .laplacian_y = {t(d.yyy) + l(d.xxy), l(d.xyy) - t(d.xyy)}};
}

/// Derivatives of ln s (u) and of X ln s (k) of second and third order.
struct SingularParts {
    double l_xx, l_xy, l_xxx, l_xxy; // l_yy = -l_xx, l_xyy = -l_xxx, l_yyy = -l_xxy
    double k_xx, k_xy, k_yy, k_xxx, k_xxy, k_xyy, k_yyy;
};

SingularParts singular_parts(const Geometry& at) {
    const double u = at.inverse, uu = u * u, X = at.X, c = at.c, q = at.q, h = q * q - c * c;
    SingularParts d{};
    d.l_xx = h * uu;
    d.l_xy = -2.0 * c * q * uu;
    d.l_xxx = 2.0 * c * (c * c - 3.0 * q * q) * uu * u;
    d.l_xxy = 2.0 * q * (3.0 * c * c - q * q) * uu * u;
    d.k_xx = 2.0 * c * u + X * d.l_xx;
    d.k_xy = q * u + X * d.l_xy;
    d.k_yy = -X * d.l_xx;
    d.k_xxx = 3.0 * d.l_xx + X * d.l_xxx;
    d.k_xxy = 2.0 * d.l_xy + X * d.l_xxy;
    d.k_xyy = -d.l_xx - X * d.l_xxx;
    d.k_yyy = -X * d.l_xxy;
    return d;
}

void add_singular(CombinationGradients& sum, const Geometry& at, const Constants& medium) {
    const double nu = medium.nu, delta = medium.delta, one_less_nu_squared = delta * (1.0 + nu);
    const SingularParts d = singular_parts(at);
    sum.yy_x += delta * d.k_xyy;
    sum.yy_y += delta * d.k_yyy;
    sum.trace_x += nu * (nu * d.k_xx - d.l_xx);
    sum.trace_y += nu * (nu * d.k_xy - d.l_xy);
    sum.shear_x += (d.k_xy - d.l_xy) + delta * d.k_xxy;
    sum.shear_y += (d.k_yy + d.l_xx) + delta * d.k_xyy;
    const Vector l{nu * (nu * d.k_xxx - d.l_xxx), nu * (nu * d.k_xxy - d.l_xxy)};
    sum.trace_gradient_x.x += l.x;
    sum.trace_gradient_x.y += l.y;
    sum.trace_gradient_y.x += l.y;
    sum.trace_gradient_y.y += nu * (nu * d.k_xyy + d.l_xxx);
    sum.laplacian_x.x += delta * d.l_xxx + d.k_xyy + nu * nu * d.k_xxx;
    sum.laplacian_y.x += delta * d.l_xxy + d.k_yyy + nu * nu * d.k_xxy;
    sum.laplacian_x.y += delta * d.l_xxy - one_less_nu_squared * d.k_xxy;
    sum.laplacian_y.y -= delta * d.l_xxx + one_less_nu_squared * d.k_xyy;
}

} // namespace

CombinationGradients gradients(const Geometry& at, const Constants& medium, const Potentials& g, bool core) {
    CombinationGradients sum = regular(medium, g);
    if (core)
        add_singular(sum, at, medium);
    return sum;
}

} // namespace rodwake::elastic
