// The singular parts of the combinations at the rod: those of -ln s + a X ln s, which the core potentials
// lack. Summed between the two potentials on paper, so that what cancels there (all of it for nu = 1, the
// shear beside the rod and the dipole on the diagonals for nu -> 0) is gone before rounding.

#include "combination.hpp"

#include <cmath>

namespace rodwake::elastic {

namespace {

/// Singular part of the laplacian's x component to twice the precision, for points where its two terms
/// cancel: it is (2 xi/r^2) [2 xi delta h + x (2 nu^2 - (1 - nu^2) h)], h = (y^2 - x^2)/r^2, over 4 xi^2. On
/// the axis ahead that happens at r = 2 delta xi/(1 + nu^2), near eta xi.
double precise_laplacian_x(const Geometry& at, const Field::Constants& medium) {
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

void add_singular(Combination& sum, const Geometry& at, const Field::Constants& medium) {
    const double nu = medium.nu, delta = medium.delta, u = at.inverse, c = at.c, q = at.q;
    const double h = (at.Y - at.X) * (at.Y + at.X) * u * u; // -cos of twice the angle, exact on the diagonals
    const double k_xx = c * u * (2.0 + h), k_xy = q * h * u, k_yy = -c * h * u; // of X ln s
    const double l_xx = h * u * u, l_xy = -2.0 * c * q * u * u;                 // of ln s
    const double one_less_nu_squared = delta * (1.0 + nu);
    sum.trace -= nu * c * u;
    sum.yy += delta * k_yy;
    sum.shear -= (nu + 2.0 * delta * c * c) * q * u;
    sum.dipole += (0.5 * delta * h + nu) * q * u;
    sum.trace_slope.x += nu * (nu * k_xx - l_xx);
    sum.trace_slope.y += nu * (nu * k_xy - l_xy);
    const double laplacian_x = delta * l_xx + one_less_nu_squared * k_yy + 2.0 * nu * nu * c * u;
    sum.laplacian.x += std::abs(laplacian_x) < cancels * std::abs(delta * l_xx)
                           ? precise_laplacian_x(at, medium)
                           : laplacian_x;
    sum.laplacian.y += delta * l_xy - one_less_nu_squared * k_xy;
}

} // namespace rodwake::elastic
