#include "rodwake/elastic/field.hpp"

#include "bessel_table.hpp"
#include "combination.hpp"
#include "field_lane.hpp"

#include <cmath>
#include <numbers>

namespace rodwake::elastic {

namespace {

Order highest_order(FieldRequest request) {
    if (request.gradients)
        return Order::third;
    return request.strain || request.polar || request.dipole ? Order::second : Order::first;
}

Vector times(double scale, Vector v) { return {scale * v.x, scale * v.y}; }

SymmetricTensor strain(double scale, double trace, double yy, double shear) {
    return {scale * (trace - 0.5 * yy), scale * 0.5 * shear, scale * 0.5 * yy};
}

/// The plain quantities; `unit` in the displacement's unit. Every member is set once: clearing them all first
/// costs as much as a Bessel function.
FieldValues plain_values(const Combination& sum, FieldRequest request, double unit, double c_shear) {
    const double second = unit * c_shear, third = second * c_shear;
    constexpr FieldValues none = unrequested();
    return {.displacement =
                request.displacement ? Vector{0.5 * unit * sum.drift, 0.5 * unit * sum.y} : none.displacement,
            .strain = request.strain ? strain(second, sum.trace, sum.yy, sum.shear) : none.strain,
            .laplacian = request.polar ? times(third, sum.laplacian) : none.laplacian,
            .gradient_of_trace = request.polar ? times(third, sum.trace_gradient) : none.gradient_of_trace,
            .dipole = request.dipole ? Vector{-second * 0.5 * sum.yy, second * sum.dipole} : none.dipole,
            .strain_x = none.strain,
            .strain_y = none.strain,
            .laplacian_x = none.laplacian,
            .laplacian_y = none.laplacian,
            .gradient_of_trace_x = none.gradient_of_trace,
            .gradient_of_trace_y = none.gradient_of_trace};
}

void add_gradients(FieldValues& f, const CombinationGradients& d, FieldRequest request, double third,
                   double fourth) {
    if (request.strain) {
        f.strain_x = strain(third, d.trace_x, d.yy_x, d.shear_x);
        f.strain_y = strain(third, d.trace_y, d.yy_y, d.shear_y);
    }
    if (request.polar) {
        f.gradient_of_trace_x = times(fourth, d.trace_gradient_x);
        f.gradient_of_trace_y = times(fourth, d.trace_gradient_y);
        f.laplacian_x = times(fourth, d.laplacian_x);
        f.laplacian_y = times(fourth, d.laplacian_y);
    }
}

/// What the kernels' algorithm leaves to do; gradients come with what they are of.
FieldRequest without_lane(FieldRequest request, bool polar) {
    if (!request.gradients) {
        request.strain = false;
        request.polar = request.polar && !polar;
    }
    return request;
}

/// A field by the kernels' algorithm, with or without its polar vectors, and beside it what that does not
/// give.
FieldValues joined(const FieldValues& lane, FieldValues more, FieldRequest request, bool polar) {
    if (request.strain)
        more.strain = lane.strain;
    if (polar) {
        more.laplacian = lane.laplacian;
        more.gradient_of_trace = lane.gradient_of_trace;
    }
    if (request.dipole)
        more.dipole.x = -lane.strain.yy; // reciprocity
    return more;
}

} // namespace

Field::Field(const Medium& medium) : medium_(medium) {
    validate(medium);
    const double sum = 1.0 + medium.eta,
                 sum_low = medium.eta >= 1.0 ? 1.0 - (sum - medium.eta) : medium.eta - (sum - 1.0);
    const double nu = 1.0 / sum;
    const double nu_low = (std::fma(-nu, sum, 1.0) - nu * sum_low) / sum;
    constants_ = {nu,
                  nu_low,
                  medium.eta / sum,
                  sum,
                  std::sqrt(sum),
                  0.5 / medium.xi,
                  2.0 * medium.xi,
                  lane_reach(medium),
                  bessel_table().rows()};
}

FieldValues Field::at(double x, double y, FieldRequest request) const {
    FieldValues f = unrequested();
    const bool polar = request.polar && lane_strain_and_polar(constants_, x, y, f);
    if (!polar && !((request.strain || request.dipole) && lane_strain(constants_, x, y, f.strain)))
        f = by_potentials(x, y, request);
    else if (request.displacement || request.dipole || request.gradients || polar != request.polar)
        f = joined(f, by_potentials(x, y, without_lane(request, polar)), request,
                   polar);    // the same bits, whatever
    else if (!request.strain) // else is asked for
        f.strain = unrequested().strain;
    return f;
}

SymmetricTensor Field::strain(double x, double y) const {
    SymmetricTensor strain;
    if (!lane_strain(constants_, x, y, strain))
        strain = by_potentials(x, y, {.strain = true}).strain;
    return strain;
}

FieldValues Field::by_potentials(double x, double y, FieldRequest request) const {
    const Constants& m = constants_;
    const Geometry at(m, x, y);
    const WaveNumber shear{{1.0, 0.0}, 1.0, 1.0},
        longitudinal{{m.nu, m.nu_low}, m.inverse_nu, m.inverse_root_nu};
    const bool core = in_core(at, m.nu);
    const Potentials g = potentials(at, shear, longitudinal, core, highest_order(request));
    Combination sum = combine(at, m, g, core);
    if (core)
        add_singular(sum, at, m);

    const double unit = 0.5 * std::numbers::inv_pi * (at.boost > 1.0 ? 1.0 / at.boost : 1.0),
                 third = unit * m.c_shear * m.c_shear;
    FieldValues f = plain_values(sum, request, unit, m.c_shear);
    if (request.gradients)
        add_gradients(f, gradients(at, m, g, core), request, third, third * m.c_shear);
    return f;
}

} // namespace rodwake::elastic
