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
Difference difference_by_integral(const Geometry& at, const Field::Constants& medium, bool core) {
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
bool nearly_equal(const Geometry& at, const Field::Constants& medium) {
    return std::abs(medium.delta) * (2.0 + at.w.high) <= 0.05;
}

} // namespace

Combination combine(const Geometry& at, const Field::Constants& medium, const Potentials& g, bool core) {
    const Derivatives& d = g.d;
    const double nu = medium.nu, t_x = d.x[0], l_xx = d.xx[1], l_xy = d.xy[1];
    Combination sum;
    sum.trace = nu * d.x[1];
    sum.trace_slope = {nu * l_xx, nu * l_xy};
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

} // namespace rodwake::elastic
