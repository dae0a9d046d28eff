#include "measured_residual.hpp"

#include "field_algebra.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::elastic {

namespace {

/// A function of one variable with three derivatives.
struct Line {
    double v, d, dd, ddd;
};

/// s((place - from)/width), by place.
Line smooth_step(double place, double width) {
    const double t = std::clamp(place / width, 0.0, 1.0), r = 1.0 - t, per = 1.0 / width;
    return {t * t * t * t * (35.0 + t * (-84.0 + t * (70.0 - 20.0 * t))), 140.0 * t * t * t * r * r * r * per,
            420.0 * t * t * r * r * (r - t) * per * per,
            840.0 * t * r * (r * r - 3.0 * t * r + t * t) * per * per * per};
}

/// Of |x|: odd derivatives change sign.
Line towards_edge(double x, const MeasuredOptions& o) {
    const Line s = smooth_step(o.edge - std::abs(x), o.blend);
    const double sign = x < 0.0 ? 1.0 : -1.0;
    return {s.v, sign * s.d, s.dd, sign * s.ddd};
}

/// f(x) g(y)
Jet outer(const Line& f, const Line& g) {
    return {f.v * g.v,  f.d * g.v,   f.v * g.d,  f.dd * g.v, f.d * g.d,
            f.v * g.dd, f.ddd * g.v, f.dd * g.d, f.d * g.dd, f.v * g.ddd};
}

/// f(r), r the distance from the rod, above 0.
Jet radial(const Line& f, double x, double y) {
    const double r = std::hypot(x, y), c = x / r, s = y / r, per = 1.0 / r;
    const double first = f.d * per;                          // f'/r
    const double second = f.dd - first;                      // along r, beyond f'/r
    const double third = f.ddd - 3.0 * per * (f.dd - first); // r^3 ((1/r) d/dr)^3 f
    return {f.v,
            f.d * c,
            f.d * s,
            first + second * c * c,
            second * c * s,
            first + second * s * s,
            third * c * c * c + 3.0 * per * second * c,
            third * c * c * s + per * second * s,
            third * c * s * s + per * second * c,
            third * s * s * s + 3.0 * per * second * s};
}

Jet product(const Jet& f, const Jet& g) {
    return {f.v * g.v,
            f.x * g.v + f.v * g.x,
            f.y * g.v + f.v * g.y,
            f.xx * g.v + 2.0 * f.x * g.x + f.v * g.xx,
            f.xy * g.v + f.x * g.y + f.y * g.x + f.v * g.xy,
            f.yy * g.v + 2.0 * f.y * g.y + f.v * g.yy,
            f.xxx * g.v + 3.0 * (f.xx * g.x + f.x * g.xx) + f.v * g.xxx,
            f.xxy * g.v + f.xx * g.y + 2.0 * (f.xy * g.x + f.x * g.xy) + f.y * g.xx + f.v * g.xxy,
            f.xyy * g.v + f.yy * g.x + 2.0 * (f.xy * g.y + f.y * g.xy) + f.x * g.yy + f.v * g.xyy,
            f.yyy * g.v + 3.0 * (f.yy * g.y + f.y * g.yy) + f.v * g.yyy};
}

SymmetricTensor strain(const Vector& by_x, const Vector& by_y) {
    return {by_x.x, 0.5 * (by_x.y + by_y.x), by_y.y};
}

/// What is made of the derivatives of (ux, uy).
FieldValues field_of(const Jet& u, const Jet& v) {
    FieldValues f{};
    f.displacement = {u.v, v.v};
    f.strain = strain({u.x, v.x}, {u.y, v.y});
    f.laplacian = {u.xx + u.yy, v.xx + v.yy};
    f.gradient_of_trace = {u.xx + v.xy, u.xy + v.yy};
    f.strain_x = strain({u.xx, v.xx}, {u.xy, v.xy});
    f.strain_y = strain({u.xy, v.xy}, {u.yy, v.yy});
    f.laplacian_x = {u.xxx + u.xyy, v.xxx + v.xyy};
    f.laplacian_y = {u.xxy + u.yyy, v.xxy + v.yyy};
    f.gradient_of_trace_x = {u.xxx + v.xxy, u.xxy + v.xyy};
    f.gradient_of_trace_y = {u.xxy + v.xyy, u.xyy + v.yyy};
    return f;
}

} // namespace

Jet edge_weight(const MeasuredOptions& options, double x, double y) {
    return outer(towards_edge(x, options), towards_edge(y, options));
}

Jet blend_weight(const MeasuredOptions& options, double x, double y) {
    const double r = std::hypot(x, y);
    if (r <= options.core)
        return {};
    const Jet edge = edge_weight(options, x, y);
    return r >= options.core + options.blend
               ? edge
               : product(radial(smooth_step(r - options.core, options.blend), x, y), edge);
}

bool MeasuredResidual::reaches(double px, double py) const {
    return std::abs(px) < options.edge && std::abs(py) < options.edge && std::hypot(px, py) > options.core;
}

void MeasuredResidual::add_to(FieldValues& f, double px, double py) const {
    const Jet w = blend_weight(options, px, py);
    const FieldValues more =
        field_of(product(w, spline_at(knots, x, px, py)), product(w, spline_at(knots, y, px, py)));
    add(f, more); // what was not asked for is NaN in f, and stays so
}

} // namespace rodwake::elastic
