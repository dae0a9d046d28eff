#include "rodwake/elastic/field.hpp"

#include "geometry.hpp"
#include "potential.hpp"
#include "rodwake/core/error.hpp"

#include <cmath>
#include <numbers>

namespace rodwake::elastic {

namespace {

/// Shear and longitudinal potential at one point. In the core both lack their ln s part, whose derivatives
/// are `log`; elsewhere `log` is zero.
struct Potentials {
    Potential shear, longitudinal;
    Derivatives log;
};

/// Both arguments at most 1: there the parts of the two potentials cancel as (r/xi)^-1.
bool in_core(const Field::Constants& medium, const Geometry& at) {
    return at.s <= 1.0 && medium.nu * at.s <= 1.0;
}

Potential potential(bool core, const Geometry& at, double a, DoubleDouble exponent, Order order) {
    return core ? core_potential(at, a, order) : scaled_potential(at, a, exponent, order);
}

Potentials potentials(const Field::Constants& medium, const Geometry& at, Order order) {
    const bool core = in_core(medium, at);
    return {potential(core, at, 1.0, at.w, order),
            potential(core, at, medium.nu, times({medium.nu, medium.nu_low}, at.w), order),
            core ? log_derivatives(at, order) : Derivatives{}};
}

/// Derivatives of D = G_T - G_L that the field needs, and d_XY (G_T - nu G_L).
struct Difference {
    double x = 0, y = 0, xy = 0, yy = 0;
    double weighted_xy = 0;
};

/// D for nearly equal potentials as the integral of dG_a/da from nu to 1 (4-point Gauss-Legendre): direct
/// subtraction would lose 1/|1 - nu|. By homogeneity a dG_a/da = (X d_X + Y d_Y) G_a.
Difference difference_by_integral(const Field::Constants& medium, const Geometry& at) {
    constexpr double node[] = {0.069431844202973712, 0.33000947820757187};
    constexpr double weight[] = {0.17392742256872693, 0.32607257743127307};
    const bool core = in_core(medium, at);
    Difference sum;
    for (int k = 0; k < 4; ++k) {
        const double fraction = k < 2 ? node[k] : 1.0 - node[3 - k];
        const double a = 1.0 - fraction * medium.delta, part = weight[k < 2 ? k : 3 - k] * medium.delta / a;
        const Derivatives d = potential(core, at, a, times({a, 0.0}, at.w), Order::third).d;
        sum.x += part * (d.x + at.X * d.xx + at.Y * d.xy);
        sum.y += part * (d.y + at.X * d.xy + at.Y * d.yy);
        sum.xy += part * (2.0 * d.xy + at.X * d.xxy + at.Y * d.xyy);
        sum.yy += part * (2.0 * d.yy + at.X * d.xyy + at.Y * d.yyy);
    }
    return sum;
}

/// The integrand varies as exp(-a w) and as a power of a: the rule is exact to 1e-16 below this bound, and
/// beyond it subtraction loses a factor 20 at most.
bool nearly_equal(const Field::Constants& medium, const Geometry& at) {
    return std::abs(medium.delta) * (2.0 + at.w.high) <= 0.05;
}

Difference difference(const Field::Constants& medium, const Geometry& at, const Potentials& g) {
    const Derivatives &t = g.shear.d, &l = g.longitudinal.d;
    if (nearly_equal(medium, at)) {
        Difference d = difference_by_integral(medium, at);
        d.weighted_xy = d.xy + medium.delta * (l.xy - g.log.xy);
        return d;
    }
    return {t.x - l.x, t.y - l.y, t.xy - l.xy, t.yy - l.yy,
            t.xy - medium.nu * l.xy - medium.delta * g.log.xy};
}

void add_slopes(FieldValues& f, const Potentials& g, const Field::Constants& m, Wanted wanted, double unit) {
    const Derivatives &t = g.shear.d, &l = g.longitudinal.d, &log = g.log;
    const double nu = m.nu, third = unit * m.c_shear * m.c_shear, fourth = third * m.c_shear;
    if (wanted.strain) {
        const double yy_x = 0.5 * (t.xyy - l.xyy), yy_y = 0.5 * (t.yyy - l.yyy);
        f.strain_x = {third * (nu * (l.xx - log.xx) - yy_x), third * 0.5 * (t.xy - log.xy + t.xxy - l.xxy),
                      third * yy_x};
        f.strain_y = {third * (nu * (l.xy - log.xy) - yy_y), third * 0.5 * (t.yy - log.yy + t.xyy - l.xyy),
                      third * yy_y};
    }
    if (wanted.polar) {
        const double delta = m.delta;
        f.gradient_of_trace_x = {fourth * nu * (l.xxx - log.xxx), fourth * nu * (l.xxy - log.xxy)};
        f.gradient_of_trace_y = {fourth * nu * (l.xxy - log.xxy), fourth * nu * (l.xyy - log.xyy)};
        f.laplacian_x = {fourth * (nu * l.xxx + t.xyy + delta * log.xxx),
                         fourth * (nu * l.xxy - t.xxy + delta * log.xxy)};
        f.laplacian_y = {fourth * (nu * l.xxy + t.yyy + delta * log.xxy),
                         fourth * (nu * l.xyy - t.xyy + delta * log.xyy)};
    }
}

Order highest_order(Wanted wanted) {
    if (wanted.slopes)
        return Order::third;
    return wanted.strain || wanted.polar || wanted.dipole ? Order::second : Order::first;
}

void require_off_the_rod(const Medium& medium, double x, double y) {
    if (!(std::abs(x) > 1e-100 * medium.xi || std::abs(y) > 1e-100 * medium.xi))
        throw InputError("the field is singular at the rod itself (r = 0): move the point off the rod");
}

} // namespace

Field::Field(const Medium& medium) : medium_(medium) {
    validate(medium);
    const double sum = 1.0 + medium.eta,
                 sum_low = medium.eta >= 1.0 ? 1.0 - (sum - medium.eta) : medium.eta - (sum - 1.0);
    const double nu = 1.0 / sum;
    const double nu_low = (std::fma(-nu, sum, 1.0) - nu * sum_low) / sum;
    constants_ = {nu, nu_low, medium.eta / sum, 0.5 / medium.xi, 2.0 * medium.xi};
}

FieldValues Field::at(double x, double y, Wanted wanted) const {
    require_off_the_rod(medium_, x, y);
    const Constants& m = constants_;
    const Geometry at(m, x, y);
    const Potentials g = potentials(m, at, highest_order(wanted));
    const Difference d = difference(m, at, g);
    const Derivatives &t = g.shear.d, &l = g.longitudinal.d, &log = g.log;
    const double unit = 0.5 * std::numbers::inv_pi, second = unit * m.c_shear, third = second * m.c_shear;

    FieldValues f;
    if (wanted.displacement)
        f.displacement = {unit * (g.shear.value + 0.5 * d.x), unit * 0.5 * d.y};
    if (wanted.strain)
        f.strain = {second * (m.nu * (l.x - log.x) - 0.5 * d.yy), second * 0.5 * (t.y - log.y + d.xy),
                    second * 0.5 * d.yy};
    if (wanted.polar) {
        f.gradient_of_trace = {third * m.nu * (l.xx - log.xx), third * m.nu * (l.xy - log.xy)};
        f.laplacian = {third * (m.nu * l.xx + t.yy + m.delta * log.xx), -third * d.weighted_xy};
    }
    if (wanted.dipole)
        f.dipole = {-second * 0.5 * d.yy, second * (0.5 * d.xy - m.nu * (l.y - log.y))};
    if (wanted.slopes)
        add_slopes(f, g, m, wanted, unit);
    return f;
}

} // namespace rodwake::elastic
