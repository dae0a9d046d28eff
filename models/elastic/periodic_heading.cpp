// How the periodic field changes as the rod turns against the box.

#include "bessel.hpp"
#include "periodic_impl.hpp"
#include "rodwake/core/error.hpp"

#include <cmath>
#include <numbers>

namespace rodwake::elastic {

namespace {

/// (1/2 pi) d_y G_T of the infinite plane, minus the curl of its field.
double minus_curl(const Medium& medium, Vector at) {
    const double c = 0.5 / medium.xi, r = std::hypot(at.x, at.y), z = c * r;
    const double k1 = z > series_end ? scaled_bessel(1.0 / z, std::sqrt(std::numbers::pi / (2.0 * z))).k1 *
                                           std::exp(-c * (r + at.x))
                                     : plain_bessel(z).k1 * std::exp(-c * at.x);
    return -0.5 * std::numbers::inv_pi * c * at.y / r * k1;
}

Vector sum(double a, Vector v, double b, Vector w) { return {a * v.x + b * w.x, a * v.y + b * w.y}; }

/// d/dx and d/dy of the dipole's field, by what the potentials obey: with d_yy C = -d_xx C - (nu/xi) d_x C
/// and the same of A, all of it is in the strain and the polar vectors.
std::array<Vector, 2> dipole_gradient(const Medium& medium, const FieldValues& f) {
    const Vector lap = f.laplacian, trace = f.gradient_of_trace;
    const double half_axy = 0.5 * (trace.y - lap.y), half_ayy = 0.5 * (lap.x - trace.x);
    return {Vector{-f.strain_x.yy, f.strain_x.xy - half_axy - trace.y},
            Vector{-f.strain_y.yy, f.strain_y.xy - half_ayy + trace.x +
                                       medium.nu() / medium.xi * (f.strain.xx + f.strain.yy)}};
}

void refuse_turned_gradients(FieldRequest request) {
    if (request.gradients)
        throw InputError("gradients of the derivative by heading are not available");
}

} // namespace

FieldValues along(const Field& field, Vector at, Vector d, FieldRequest request) {
    const FieldValues f = field.at(at.x, at.y, {.strain = true, .polar = true, .gradients = true});
    FieldValues g = unrequested();
    if (request.displacement) {
        const double half = 0.5 * minus_curl(field.medium(), at);
        g.displacement = {f.strain.xx * d.x + (f.strain.xy + half) * d.y,
                          (f.strain.xy - half) * d.x + f.strain.yy * d.y};
    }
    if (request.strain)
        g.strain = {d.x * f.strain_x.xx + d.y * f.strain_y.xx, d.x * f.strain_x.xy + d.y * f.strain_y.xy,
                    d.x * f.strain_x.yy + d.y * f.strain_y.yy};
    if (request.polar) {
        g.laplacian = sum(d.x, f.laplacian_x, d.y, f.laplacian_y);
        g.gradient_of_trace = sum(d.x, f.gradient_of_trace_x, d.y, f.gradient_of_trace_y);
    }
    const auto [dipole_x, dipole_y] = dipole_gradient(field.medium(), f);
    if (request.dipole)
        g.dipole = sum(d.x, dipole_x, d.y, dipole_y);
    return g;
}

const PeriodicField::Impl::Turning& PeriodicField::Impl::turning() const {
    std::call_once(turning_once_, [this] {
        const auto turned = [this](double c) {
            return PeriodicPotential(WaveVector::by_heading(c, cosine, sine), sides);
        };
        turning_.emplace(Turning{turned(shear.c()), turned(longitudinal.c())});
    });
    return *turning_;
}

/// In the box's axes the wave vector turns, and with the rod's frame the place: about the rod itself, not
/// about the image nearest to it.
FieldValues PeriodicField::Impl::rest_by_heading(const NearestImage& p, FieldRequest request) const {
    const double x = (p.shift.x + p.offset.x) / unit, y = (p.shift.y + p.offset.y) / unit;
    Needed needed{.second = true, .third = needed_for(request).second, .by_c = true};
    const Jets t = turning().shear.at(p.x, p.y, needed), l = turning().longitudinal.at(p.x, p.y, needed);
    const Jet t_wave = to_rod(t.by_c, false), l_wave = to_rod(l.by_c, false),
              t_place = by_angle(x, y, to_rod(t.g, true)), l_place = by_angle(x, y, to_rod(l.g, true));
    // The derivatives by the wave vector are of order c: no need of the integral over it
    const Jet b_place = between ? by_angle(x, y, parts(p.x, p.y, needed).b) : xi * (t_place + -1.0 * l_place);
    return assembled({t_wave + t_place, xi * (t_wave + -1.0 * l_wave) + b_place, nu * (l_wave + l_place)},
                     request, unit, 1.0 / xi, 0.0);
}

FieldValues PeriodicField::by_heading(double x, double y, FieldRequest request) const {
    refuse_turned_gradients(request);
    const NearestImage p = impl_->nearest(x, y);
    FieldValues f = impl_->rest_by_heading(p, request);
    if (is_near(p.x, p.y) && (p.shift.x != 0.0 || p.shift.y != 0.0))
        add(f, along(impl_->field, p.offset, {-p.shift.y, p.shift.x}, request));
    return f;
}

FieldValues PeriodicField::own_place_by_heading(FieldRequest request) const {
    refuse_turned_gradients(request);
    return impl_->rest_by_heading({0.0, 0.0, {}, {}}, request);
}

} // namespace rodwake::elastic
