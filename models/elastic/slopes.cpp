// Derivatives of the combinations: third derivatives of the two potentials.

#include "combination.hpp"

namespace rodwake::elastic {

namespace {

CombinationSlopes regular(const Field::Constants& medium, const Potentials& g) {
    const double nu = medium.nu;
    const auto t = [](Pair both) { return both[0]; };
    const auto l = [nu](Pair both) { return nu * both[1]; };
    const auto difference = [](Pair both) { return both[0] - both[1]; };
    const Derivatives& d = g.d;
    return {.yy_x = difference(d.xyy),
            .yy_y = difference(d.yyy),
            .trace_x = l(d.xx),
            .trace_y = l(d.xy),
            .shear_x = t(d.xy) + difference(d.xxy),
            .shear_y = t(d.yy) + difference(d.xyy),
            .trace_slope_x = {l(d.xxx), l(d.xxy)},
            .trace_slope_y = {l(d.xxy), l(d.xyy)},
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

void add_singular(CombinationSlopes& sum, const Geometry& at, const Field::Constants& medium) {
    const double nu = medium.nu, delta = medium.delta, one_less_nu_squared = delta * (1.0 + nu);
    const SingularParts d = singular_parts(at);
    sum.yy_x += delta * d.k_xyy;
    sum.yy_y += delta * d.k_yyy;
    sum.trace_x += nu * (nu * d.k_xx - d.l_xx);
    sum.trace_y += nu * (nu * d.k_xy - d.l_xy);
    sum.shear_x += (d.k_xy - d.l_xy) + delta * d.k_xxy;
    sum.shear_y += (d.k_yy + d.l_xx) + delta * d.k_xyy;
    const Vector l{nu * (nu * d.k_xxx - d.l_xxx), nu * (nu * d.k_xxy - d.l_xxy)};
    sum.trace_slope_x.x += l.x;
    sum.trace_slope_x.y += l.y;
    sum.trace_slope_y.x += l.y;
    sum.trace_slope_y.y += nu * (nu * d.k_xyy + d.l_xxx);
    sum.laplacian_x.x += delta * d.l_xxx + d.k_xyy + nu * nu * d.k_xxx;
    sum.laplacian_y.x += delta * d.l_xxy + d.k_yyy + nu * nu * d.k_xxy;
    sum.laplacian_x.y += delta * d.l_xxy - one_less_nu_squared * d.k_xxy;
    sum.laplacian_y.y -= delta * d.l_xxx + one_less_nu_squared * d.k_xyy;
}

} // namespace

CombinationSlopes slopes(const Geometry& at, const Field::Constants& medium, const Potentials& g, bool core) {
    CombinationSlopes sum = regular(medium, g);
    if (core)
        add_singular(sum, at, medium);
    return sum;
}

} // namespace rodwake::elastic
