// In X = c_T x, Y = c_T y every quantity is made of derivatives of G_a, a = 1 or nu, and a change of the
// medium acts on them by E = a dG_a/da = (X d_X + Y d_Y) G_a. What is singular at the rod is summed on paper:
// of -ln s + a X ln s, E keeps a (X ln s + X), so the largest parts of the field hardly know the medium.

#include "rodwake/elastic/medium.hpp"
#include "rodwake/elastic/medium_derivatives.hpp"

#include "bessel.hpp"
#include "combination.hpp"
#include "rodwake/core/error.hpp"

#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

namespace rodwake::elastic {

namespace {

/// Derivatives of G and of E; in the core without the singular parts.
struct Scaled {
    Derivatives g;
    Pair x, y, xx, xy, yy; ///< of E

    Scaled(const Geometry& at, const Derivatives& d)
        : g(d), x(d.x + at.X * d.xx + at.Y * d.xy), y(d.y + at.X * d.xy + at.Y * d.yy),
          xx(2.0 * d.xx + at.X * d.xxx + at.Y * d.xxy), xy(2.0 * d.xy + at.X * d.xxy + at.Y * d.xyy),
          yy(2.0 * d.yy + at.X * d.xyy + at.Y * d.yyy) {}
};

/// Second derivatives of ln s and of X ln s, and the first of ln s.
struct Singular {
    double l_x = 0, l_y = 0, l_xx = 0, l_xy = 0, k_xx = 0, k_xy = 0, k_yy = 0;

    Singular() = default; ///< away from the core: none
    explicit Singular(const Geometry& at) {
        const double u = at.inverse, c = at.c, q = at.q, h = (at.Y - at.X) * (at.Y + at.X) * u * u;
        l_x = c * u;
        l_y = q * u;
        l_xx = h * u * u;
        l_xy = -2.0 * c * q * u * u;
        k_xx = c * u * (2.0 + h);
        k_xy = q * h * u;
        k_yy = -c * h * u;
    }
};

/// The longitudinal potential complete, times `boost`: first and second derivatives of G_L and of E_L.
struct Longitudinal {
    double g_x, g_y, g_xx, g_xy;
    double x, y, xx, xy, yy;
};

Longitudinal complete(const Scaled& s, const Singular& at_rod, double nu, double constant) {
    return {.g_x = s.g.x[1] - at_rod.l_x,
            .g_y = s.g.y[1] - at_rod.l_y,
            .g_xx = s.g.xx[1] - at_rod.l_xx + nu * at_rod.k_xx,
            .g_xy = s.g.xy[1] - at_rod.l_xy + nu * at_rod.k_xy,
            .x = s.x[1] + constant,
            .y = s.y[1],
            .xx = s.xx[1] + nu * at_rod.k_xx,
            .xy = s.xy[1] + nu * at_rod.k_xy,
            .yy = s.yy[1] + nu * at_rod.k_yy};
}

/// What an n-th derivative of U turns into: (n + X d_X + Y d_Y) of the combinations. In D the singular parts
/// cancel but for the constant.
Combination by_scale(const Geometry& at, const Constants& medium, const Scaled& s, const Longitudinal& l,
                     bool core) {
    const auto difference = [](Pair both) { return both[0] - both[1]; };
    const double nu = medium.nu, shear = at.X * s.g.x[0] + at.Y * s.g.y[0] - (core ? 1.0 : 0.0);
    const double D_xy = difference(s.xy - s.g.xy);
    Combination sum{};
    sum.drift = 2.0 * shear + difference(s.x - s.g.x) + (core ? medium.delta : 0.0);
    sum.y = difference(s.y - s.g.y);
    sum.trace = nu * l.x;
    sum.yy = difference(s.yy - s.g.yy);
    sum.shear = s.y[0] + D_xy;
    sum.dipole = 0.5 * D_xy - nu * l.y;
    sum.trace_gradient = {nu * l.xx, nu * l.xy};
    if (!core) {
        sum.laplacian = {s.yy[0] + nu * l.xx, nu * l.xy - s.xy[0]};
        return sum;
    }
    const Singular at_rod(at);
    const double one_less_nu_squared =
        medium.delta * (1.0 + nu); // not k_yy + nu^2 k_xx: nothing is left of it
    sum.laplacian = {s.yy[0] + nu * s.xx[1] + 2.0 * nu * nu * at_rod.l_x + one_less_nu_squared * at_rod.k_yy,
                     nu * s.xy[1] - s.xy[0] - one_less_nu_squared * at_rod.k_xy};
    return sum;
}

FieldValues values(const Combination& sum, FieldRequest request, double unit, double c_shear) {
    const double second = unit * c_shear, third = second * c_shear;
    FieldValues f = unrequested();
    if (request.displacement)
        f.displacement = {0.5 * unit * sum.drift, 0.5 * unit * sum.y};
    if (request.strain)
        f.strain = {second * (sum.trace - 0.5 * sum.yy), second * 0.5 * sum.shear, second * 0.5 * sum.yy};
    if (request.polar) {
        f.laplacian = times(third, sum.laplacian);
        f.gradient_of_trace = times(third, sum.trace_gradient);
    }
    if (request.dipole)
        f.dipole = {-second * 0.5 * sum.yy, second * sum.dipole};
    return f;
}

} // namespace

MediumDerivatives medium_derivatives(const Field& field, double x, double y, FieldRequest request) {
    if (request.gradients)
        throw InputError("derivatives of the field's gradients with respect to the medium are not available: "
                         "request displacement, strain, polar or dipole");
    const Constants& m = FieldInternals::constants(field);
    const Geometry at(m, x, y);
    const Order order = request.strain || request.polar || request.dipole ? Order::third : Order::second;
    const WaveNumber shear{{1.0, 0.0}, 1.0, 1.0},
        longitudinal{{m.nu, m.nu_low}, m.inverse_nu, m.inverse_root_nu};
    // The longitudinal potential alone can be in its core: for a nearly incompressible medium far out.
    const bool core = in_core(at, m.nu), own_core = m.nu * at.s <= series_end;
    const Scaled both(at, potentials(at, shear, longitudinal, core, order).d);
    Longitudinal own = complete(both, own_core ? Singular(at) : Singular(), m.nu, own_core ? m.nu : 0.0);
    if (own_core && !core) {
        own = complete(Scaled(at, core_potentials(at, longitudinal, longitudinal, order).d), Singular(at),
                       m.nu, m.nu);
        for (double* v :
             {&own.g_x, &own.g_y, &own.g_xx, &own.g_xy, &own.x, &own.y, &own.xx, &own.xy, &own.yy})
            *v *= at.boost;
    }
    Combination by_nu{}; // nu d/dnu of the combinations
    by_nu.drift = -own.x;
    by_nu.y = -own.y;
    by_nu.trace = m.nu * (own.g_x + own.x);
    by_nu.yy = -own.yy;
    by_nu.shear = -own.xy;
    by_nu.dipole = -0.5 * own.xy - m.nu * (own.g_y + own.y);
    by_nu.trace_gradient = {m.nu * (own.g_xx + own.xx), m.nu * (own.g_xy + own.xy)};
    by_nu.laplacian = by_nu.trace_gradient;
    const double unit = 0.5 * std::numbers::inv_pi * (at.boost > 1.0 ? 1.0 / at.boost : 1.0);
    return {values(by_nu, request, -unit * m.nu, m.c_shear),
            values(by_scale(at, m, both, own, core), request, -unit / field.medium().xi, m.c_shear)};
}

namespace {

void require(bool legal, const std::string& name, double value, const std::string& range) {
    if (legal)
        return;
    std::ostringstream message;
    message << name << " = " << value << ": must be " << range;
    throw InputError(message.str());
}

} // namespace

void validate(const Medium& medium) {
    require(medium.eta > -1.0 && medium.eta <= Medium::max_eta, "eta", medium.eta,
            "> -1 (the longitudinal modulus (1 + eta) mu must be positive) and at most 1e12");
    require(medium.xi >= Medium::min_xi && medium.xi <= Medium::max_xi, "xi", medium.xi,
            "> 0, in [1e-30, 1e30]");
}

double eta_from_lame(double lame_lambda, double mu) {
    require(mu > 0.0, "mu", mu, "> 0");
    require(lame_lambda > -2.0 * mu, "lame_lambda", lame_lambda, "> -2 mu");
    return (lame_lambda + mu) / mu;
}

double eta_from_bulk_modulus(double bulk_modulus, double mu) {
    require(mu > 0.0, "mu", mu, "> 0");
    require(bulk_modulus > -mu, "bulk_modulus", bulk_modulus, "> -mu");
    return bulk_modulus / mu;
}

double eta_from_poisson_ratio(double ratio) {
    require(ratio > -1.0 && ratio < 1.0, "poisson_ratio", ratio, "between -1 and 1 (two dimensions)");
    return (1.0 + ratio) / (1.0 - ratio);
}

double poisson_ratio(double eta) {
    require(eta > -1.0, "eta", eta, "> -1");
    return (eta - 1.0) / (eta + 1.0);
}

double xi_from_alpha(double alpha, double f_over_mu) {
    require(alpha > 0.0 && std::isfinite(alpha), "alpha", alpha, "> 0 and finite");
    require(f_over_mu > 0.0 && std::isfinite(f_over_mu), "f_over_mu", f_over_mu, "> 0 and finite");
    return f_over_mu / alpha;
}

} // namespace rodwake::elastic
