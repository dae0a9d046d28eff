// The singular parts of the combinations at the rod: those of -ln s + a X ln s, which the core potentials
// lack. Summed between the two potentials on paper, so that what cancels there (all of it for nu = 1, the
// shear beside the rod and the dipole on the diagonals for nu -> 0) is gone before rounding.

#include "combination.hpp"

namespace rodwake::elastic {

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
    sum.laplacian.x += delta * l_xx + one_less_nu_squared * k_yy + 2.0 * nu * nu * c * u;
    sum.laplacian.y += delta * l_xy - one_less_nu_squared * k_xy;
}

} // namespace rodwake::elastic
