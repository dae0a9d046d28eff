#include "rodwake/elastic/periodic.hpp"

#include "bessel.hpp"
#include "periodic_impl.hpp"
#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/wake_field.hpp"

#include <cmath>
#include <numbers>
#include <sstream>

namespace rodwake::elastic {

namespace {

/// Potentials with c L above it need thousands of terms; L the longer side.
constexpr double largest_c = 1e6;
/// Of L/xi: below it powers of it underflow; L the shorter side.
constexpr double smallest_ratio = 1e-100;
/// Of a box's longer side over its shorter one: the number of terms grows with it.
constexpr double largest_aspect = 1e3;
/// Of c L, L the longer side. Below it G_T - G_L is an integral over c: subtraction would lose 1/c L.
constexpr double small_c = 1e-2;

[[noreturn]] void refuse_box(const PeriodicBox& box, const char* why) {
    throw InputError("box = " + to_string(box) + ": " + why);
}

[[noreturn]] void refuse_place(double x, double y, const char* why) {
    std::ostringstream message;
    message << "field at x = " << x << ", y = " << y << ": " << why;
    throw InputError(message.str());
}

void refuse_gradients(FieldRequest request) {
    if (request.gradients)
        throw InputError(
            "gradients of the derivatives by the medium are not available; use finite differences");
}

} // namespace

FieldValues assembled(const JetParts& p, FieldRequest request, double unit, double shear_decay,
                      double uniform) {
    const double first = 0.5 * std::numbers::inv_pi, second = first / unit, third = second / unit;
    FieldValues f = unrequested();
    if (request.displacement)
        f.displacement = {first * (p.a.v + p.b.x), first * p.b.y};
    if (request.strain)
        f.strain = {second * (p.a.x + p.b.xx), second * (0.5 * p.a.y + p.b.xy), second * p.b.yy};
    if (request.dipole)
        f.dipole = {-second * p.b.yy, second * (p.b.xy - p.c.y)};
    if (request.polar) {
        f.laplacian = {third * (2.0 * std::numbers::pi * uniform - shear_decay * p.a.x - p.a.xx + p.c.xx),
                       third * (p.c.xy - p.a.xy)};
        f.gradient_of_trace = {third * p.c.xx, third * p.c.xy};
    }
    if (!request.gradients)
        return f;
    const auto& [a, b, c] = p;
    const double fourth = third / unit;
    if (request.strain) {
        f.strain_x = {third * (a.xx + b.xxx), third * (0.5 * a.xy + b.xxy), third * b.xyy};
        f.strain_y = {third * (a.xy + b.xxy), third * (0.5 * a.yy + b.xyy), third * b.yyy};
    }
    if (request.polar) {
        f.laplacian_x = {fourth * (c.xxx - a.xxx - shear_decay * a.xx), fourth * (c.xxy - a.xxy)};
        f.laplacian_y = {fourth * (c.xxy - a.xxy - shear_decay * a.xy), fourth * (c.xyy - a.xyy)};
        f.gradient_of_trace_x = {fourth * c.xxx, fourth * c.xxy};
        f.gradient_of_trace_y = {fourth * c.xxy, fourth * c.xyy};
    }
    return f;
}

Needed needed_for(FieldRequest request) {
    return {.second = request.strain || request.dipole || request.polar, .third = request.gradients};
}

PeriodicField::Impl::Impl(const Medium& m, const PeriodicBox& whole, double angle)
    : medium(m), box(whole), unit(whole.shorter()), sides(whole.x / unit, whole.y / unit), heading(angle),
      cosine(std::cos(angle)), sine(std::sin(angle)), field(m), xi(m.xi / unit), nu(m.nu()),
      shear(WaveVector::by_c(0.5 / xi, cosine, sine), sides),
      longitudinal(WaveVector::by_c(nu * 0.5 / xi, cosine, sine), sides) {
    const double node = 0.5 / std::sqrt(3.0), mean = 0.5 * (1.0 + nu), span = 1.0 - nu;
    const auto potential = [&](double share) {
        return PeriodicPotential(WaveVector::by_c(share * 0.5 / xi, cosine, sine), sides);
    };
    if (0.5 / xi * std::max(1.0, nu) * sides.longer() < small_c)
        between = {potential(mean - node * span), potential(mean + node * span)};
}

NearestImage PeriodicField::Impl::nearest(double x, double y) const {
    if (!std::isfinite(x) || !std::isfinite(y))
        refuse_place(x, y, "the position must be finite");
    const Vector lab = turned(Vector{x / unit, y / unit}, cosine, sine);
    const double i = std::nearbyint(lab.x / sides.x), j = std::nearbyint(lab.y / sides.y);
    const Vector shift = turned(Vector{i * box.x, j * box.y}, cosine, -sine);
    const Vector offset{x - shift.x, y - shift.y};
    if (offset.x == 0.0 && offset.y == 0.0)
        refuse_place(x, y, "the field is singular there, at the rod or one of its images: move the point");
    return {lab.x - i * sides.x, lab.y - j * sides.y, shift, offset};
}

JetParts PeriodicField::Impl::parts(double x, double y, Needed needed) const {
    needed.by_c = false;
    const Jet t = to_rod(shear.at(x, y, needed).g, needed.third),
              l = to_rod(longitudinal.at(x, y, needed).g, needed.third);
    return {t, between ? b_between(x, y, needed) : xi * (t + -1.0 * l), nu * l};
}

/// xi (G_T - G_L) = xi int dG/dc dc from c_L to c_T; 2-point Gauss-Legendre, error below c^4/4320 (c times
/// the longer side).
Jet PeriodicField::Impl::b_between(double x, double y, Needed needed) const {
    needed.by_c = needed.without_log = true;
    Jet sum;
    for (const PeriodicPotential& node : *between)
        sum += 0.25 * (1.0 - nu) * to_rod(node.at(x, y, needed).by_c, needed.third);
    if (is_near(x, y))
        sum += xi * (logarithm(shear.c(), x, y, needed.third) +
                     -1.0 * logarithm(longitudinal.c(), x, y, needed.third));
    return sum;
}

/// ln(c) (exp(-c x) I0(c r) - 1) in the rod's axes; the 1 has no gradient.
Jet PeriodicField::Impl::logarithm(double c, double x, double y, bool third) const {
    const Vector at = turned(Vector{x, y}, cosine, -sine);
    Jet f = c * c * std::numbers::inv_pi * uniform_part(c, at.x, at.y, third).g;
    f.v -= c * at.x;
    f.x -= c;
    return std::log(c) * f;
}

FieldValues PeriodicField::Impl::rest(double x, double y, FieldRequest request) const {
    return assembled(parts(x, y, needed_for(request)), request, unit, 1.0 / xi, 1.0 / sides.area());
}

/// dc_T/dxi = -c_T/xi, dc_L/deta = -nu^2 c_T; xi in this unit.
MediumDerivatives PeriodicField::Impl::rest_derivatives(double x, double y, FieldRequest request) const {
    Needed needed = needed_for(request);
    needed.by_c = true;
    const WaveVectorJets t = shear.at(x, y, needed), l = longitudinal.at(x, y, needed);
    const Jet gt = to_rod(t.g, false), gl = to_rod(l.g, false), ct = shear.c() * to_rod(t.by_c, false),
              cl = longitudinal.c() * to_rod(l.by_c, false);
    const JetParts by_eta{{}, xi * nu * cl, -nu * nu * (gl + cl)};
    const double per = 1.0 / unit; // xi of the caller's over xi here
    const JetParts by_xi{(-per / xi) * ct, per * (gt + -1.0 * gl + -1.0 * ct + cl), (-per * nu / xi) * cl};
    MediumDerivatives d{assembled(by_eta, request, unit, 1.0 / xi, 0.0),
                        assembled(by_xi, request, unit, 1.0 / xi, 0.0)};
    if (request.polar) // the shear decay 1/xi itself
        d.by_xi.laplacian.x += 0.5 * std::numbers::inv_pi * gt.x / (xi * xi * unit * unit * unit);
    return d;
}

PeriodicField::PeriodicField(const Medium& medium, const PeriodicBox& box, double heading) {
    validate(medium);
    if (!valid_sides(box))
        refuse_box(box, "the sides of the periodic box must be > 0 and finite");
    if (!(box.longer() <= largest_aspect * box.shorter()))
        refuse_box(box, "one side is more than 1000 times the other; take sides that are closer");
    if (!(0.5 * box.longer() / medium.xi * std::max(1.0, medium.nu()) <= largest_c))
        refuse_box(box, "more than 2e6 decay lengths of the field; leave the box out (infinite plane)");
    if (!(box.shorter() / medium.xi >= smallest_ratio))
        refuse_box(box, "less than 1e-100 screening lengths; check the units");
    if (!std::isfinite(heading)) {
        std::ostringstream message;
        message << "heading = " << heading << ": must be finite";
        throw InputError(message.str());
    }
    impl_ = std::make_shared<const Impl>(medium, box, heading);
}

FieldValues PeriodicField::at(double x, double y, FieldRequest request) const {
    const NearestImage p = impl_->nearest(x, y);
    FieldValues f = impl_->rest(p.x, p.y, request);
    if (is_near(p.x, p.y))
        add(f, impl_->field.at(p.offset.x, p.offset.y, request));
    return f;
}

FieldValues PeriodicField::self_image_field(FieldRequest request) const {
    return impl_->rest(0.0, 0.0, request);
}

MediumDerivatives PeriodicField::medium_derivatives(double x, double y, FieldRequest request) const {
    refuse_gradients(request);
    const NearestImage p = impl_->nearest(x, y);
    MediumDerivatives d = impl_->rest_derivatives(p.x, p.y, request);
    if (is_near(p.x, p.y)) {
        const MediumDerivatives own =
            elastic::medium_derivatives(impl_->field, p.offset.x, p.offset.y, request);
        add(d.by_eta, own.by_eta);
        add(d.by_xi, own.by_xi);
    }
    return d;
}

MediumDerivatives PeriodicField::own_place_by_medium(FieldRequest request) const {
    refuse_gradients(request);
    return impl_->rest_derivatives(0.0, 0.0, request);
}

FieldValues PeriodicInternals::smooth_rest(const PeriodicField& field, double x, double y,
                                           FieldRequest request) {
    const PeriodicField::Impl& own = *field.impl_;
    FieldValues rest = own.rest(x, y, request);
    if (!is_near(x, y)) {
        const Vector offset = turned(Vector{x * own.unit, y * own.unit}, own.cosine, -own.sine);
        add_times(rest, -1.0, own.field.at(offset.x, offset.y, request));
    }
    return rest;
}

const Medium& PeriodicField::medium() const { return impl_->medium; }
const PeriodicBox& PeriodicField::box() const { return impl_->box; }
double PeriodicField::heading() const { return impl_->heading; }

// How the periodic field changes as the rod turns against the box.

namespace {

Vector sum(double a, Vector v, double b, Vector w) { return {a * v.x + b * w.x, a * v.y + b * w.y}; }

void refuse_turned_gradients(FieldRequest request) {
    if (request.gradients)
        throw InputError("gradients of the derivative by heading are not available");
}

} // namespace

FieldValues along(const Field& field, Vector at, Vector d, FieldRequest request) {
    const FieldValues f = field.at(at.x, at.y, {.strain = true, .polar = true, .gradients = true});
    FieldValues g = unrequested();
    if (request.displacement) {
        // (1/2 pi) d_y G_T is minus the curl.
        const double c = 0.5 / field.medium().xi, r = std::hypot(at.x, at.y), z = c * r;
        const double k1 = z > series_end
                              ? scaled_bessel(1.0 / z, std::sqrt(std::numbers::pi / (2.0 * z))).k1 *
                                    std::exp(-c * (r + at.x))
                              : plain_bessel(z).k1 * std::exp(-c * at.x);
        const double half = 0.5 * (-0.5 * std::numbers::inv_pi * c * at.y / r * k1);
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
    if (request.dipole) {
        // The potentials obey d_yy C = -d_xx C - (nu/xi) d_x C, and A the same, so all of it is in the strain
        // and the polar vectors.
        const Vector lap = f.laplacian, trace = f.gradient_of_trace;
        const double half_axy = 0.5 * (trace.y - lap.y), half_ayy = 0.5 * (lap.x - trace.x);
        const Vector dipole_x{-f.strain_x.yy, f.strain_x.xy - half_axy - trace.y},
            dipole_y{-f.strain_y.yy,
                     f.strain_y.xy - half_ayy + trace.x +
                         field.medium().nu() / field.medium().xi * (f.strain.xx + f.strain.yy)};
        g.dipole = sum(d.x, dipole_x, d.y, dipole_y);
    }
    return g;
}

const PeriodicField::Impl::Turning& PeriodicField::Impl::turning() const {
    std::call_once(turning_once_, [this] {
        const auto turned = [this](double c) {
            return PeriodicPotential(WaveVector::heading_derivative(c, cosine, sine), sides);
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
    const WaveVectorJets t = turning().shear.at(p.x, p.y, needed),
                         l = turning().longitudinal.at(p.x, p.y, needed);
    const Jet t_wave = to_rod(t.by_c, false), l_wave = to_rod(l.by_c, false),
              t_place = by_angle(x, y, to_rod(t.g, true)), l_place = by_angle(x, y, to_rod(l.g, true));
    // The derivatives by the wave vector are of order c: no need of the integral over it
    const Jet b_place = between ? by_angle(x, y, parts(p.x, p.y, needed).b) : xi * (t_place + -1.0 * l_place);
    return assembled({t_wave + t_place, xi * (t_wave + -1.0 * l_wave) + b_place, nu * (l_wave + l_place)},
                     request, unit, 1.0 / xi, 0.0);
}

FieldValues PeriodicField::heading_derivative(double x, double y, FieldRequest request) const {
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
