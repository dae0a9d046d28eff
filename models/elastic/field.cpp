// The exact field behind elastic/wake_field.hpp: on the plane one wake for all headings, in a box one each.

#include "rodwake/elastic/field.hpp"

#include "bessel.hpp"
#include "combination.hpp"
#include "field_algebra.hpp"
#include "geometry.hpp"
#include "rodwake/elastic/mutual_wakes.hpp"
#include "rodwake/elastic/periodic.hpp"
#include "rodwake/elastic/wake_field.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace rodwake::elastic {

namespace {

class PlaneWake final : public Wake {
public:
    explicit PlaneWake(const Medium& medium) : field(medium) {}

    FieldValues at(double x, double y, FieldRequest request) const override {
        return field.at(x, y, request);
    }
    MediumDerivatives medium_derivatives(double x, double y, FieldRequest request) const override {
        return elastic::medium_derivatives(field, x, y, request);
    }

    const Field field;
};

class PlaneField final : public WakeField {
public:
    PlaneField(const Medium& medium, const MutualWakesOptions& sums)
        : wake_(std::make_shared<const PlaneWake>(medium)), kernels_(medium, sums) {}

    const Medium& medium() const override { return wake_->field.medium(); }
    std::shared_ptr<const Wake> wake(double /*heading*/) const override { return wake_; }
    void mutual(std::span<const Source> rods, FieldRequest request,
                std::span<FieldValues> sums) const override;

private:
    std::shared_ptr<const PlaneWake> wake_;
    MutualWakes kernels_;
};

void PlaneField::mutual(std::span<const Source> rods, FieldRequest request,
                        std::span<FieldValues> sums) const {
    constexpr std::size_t worth_kernels = 8; // fewer fill too little of a tile
    const bool few = rods.size() < worth_kernels;
    if (rods.size() != sums.size() || request.displacement || request.dipole || (few && request.polar))
        return WakeField::mutual(rods, request, sums);

    // Few rods by the shortest way to the strain: the bits of WakeField::mutual.
    if (few) {
        for (FieldValues& sum : sums)
            sum = empty_sum({.strain = true});
        for (std::size_t b = 0; b < rods.size(); ++b) {
            const double cosine = std::cos(rods[b].heading), sine = std::sin(rods[b].heading);
            for (std::size_t a = 0; a < rods.size(); ++a) {
                if (a == b)
                    continue;
                const Vector at = turned(Vector{rods[a].x - rods[b].x, rods[a].y - rods[b].y}, cosine, -sine);
                const SymmetricTensor lab = turned(wake_->field.strain(at.x, at.y), cosine, sine);
                SymmetricTensor& sum = sums[a].strain;
                sum = {sum.xx + lab.xx, sum.xy + lab.xy, sum.yy + lab.yy};
            }
        }
        return;
    }

    // Many by the kernels, which fill columns.
    std::vector<double> numbers(7 * rods.size());
    const auto column = [&](std::size_t k) {
        return std::span(numbers).subspan(k * rods.size(), rods.size());
    };
    const StrainSums strain{column(0), column(1), column(2)};
    const PolarSums polar{column(3), column(4), column(5), column(6)};
    if (request.polar)
        kernels_.strain_and_polar(rods, strain, polar);
    else
        kernels_.strain(rods, strain);
    for (std::size_t a = 0; a < rods.size(); ++a) {
        sums[a] = unrequested();
        sums[a].strain = {strain.xx[a], strain.xy[a], strain.yy[a]};
        if (request.polar) {
            sums[a].laplacian = {polar.laplacian_x[a], polar.laplacian_y[a]};
            sums[a].gradient_of_trace = {polar.gradient_x[a], polar.gradient_y[a]};
        }
    }
}

class BoxField final : public WakeField {
public:
    BoxField(const Medium& medium, const PeriodicBox& box) : medium_(medium), box_(box) { validate(medium); }

    const Medium& medium() const override { return medium_; }
    std::optional<PeriodicBox> box() const override { return box_; }
    std::shared_ptr<const Wake> wake(double heading) const override {
        return std::make_shared<const PeriodicField>(medium_, box_, heading);
    }

private:
    Medium medium_;
    PeriodicBox box_;
};

} // namespace

std::shared_ptr<const WakeField> exact_field(const Medium& medium, std::optional<PeriodicBox> box,
                                             const MutualWakesOptions& sums) {
    if (box)
        return std::make_shared<const BoxField>(medium, *box);
    return std::make_shared<const PlaneField>(medium, sums);
}

namespace {

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
    else if (request.displacement || request.dipole || request.gradients || polar != request.polar) {
        // The potentials give what the kernels' algorithm leaves to do; gradients come with what they are of.
        // The strain and the polar vectors stay those of the kernels: the same bits, whatever else is asked
        // for.
        FieldRequest rest = request;
        rest.strain = request.strain && request.gradients;
        rest.polar = request.polar && (request.gradients || !polar);
        FieldValues more = by_potentials(x, y, rest);
        if (request.strain)
            more.strain = f.strain;
        if (polar) {
            more.laplacian = f.laplacian;
            more.gradient_of_trace = f.gradient_of_trace;
        }
        if (request.dipole)
            more.dipole.x = -f.strain.yy; // reciprocity
        f = more;
    } else if (!request.strain)
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
    const Order order = request.gradients                                   ? Order::third
                        : request.strain || request.polar || request.dipole ? Order::second
                                                                            : Order::first;
    const Potentials g = potentials(at, shear, longitudinal, core, order);
    Combination sum = combine(at, m, g, core);
    if (core)
        add_singular(sum, at, m);

    const double unit = 0.5 * std::numbers::inv_pi * (at.boost > 1.0 ? 1.0 / at.boost : 1.0),
                 third = unit * m.c_shear * m.c_shear;
    FieldValues f = plain_values(sum, request, unit, m.c_shear);
    if (!request.gradients)
        return f;
    const CombinationGradients d = gradients(at, m, g, core);
    const double fourth = third * m.c_shear;
    if (request.strain) {
        f.strain_x = elastic::strain(third, d.trace_x, d.yy_x, d.shear_x);
        f.strain_y = elastic::strain(third, d.trace_y, d.yy_y, d.shear_y);
    }
    if (request.polar) {
        f.gradient_of_trace_x = times(fourth, d.trace_gradient_x);
        f.gradient_of_trace_y = times(fourth, d.trace_gradient_y);
        f.laplacian_x = times(fourth, d.laplacian_x);
        f.laplacian_y = times(fourth, d.laplacian_y);
    }
    return f;
}

} // namespace rodwake::elastic
