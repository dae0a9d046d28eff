#include "closed_rates.hpp"

#include "phi.hpp"
#include "rods/interaction.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/medium/turning_wake.hpp"
#include "rodwake/rods/classify_outcome.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::medium {

ClosedRates::ClosedRates(const elastic::Medium& elastic, const DynamicMedium& medium,
                         const rods::Couplings& couplings, std::size_t rods, std::size_t threads)
    : modes_(elastic, medium), couplings_(couplings), self_field_(medium.self_field),
      first_order_(medium.closure == Closure::first_order), team_(threads),
      fields_(4 * modes_.size() * (medium.self_field ? 1 : rods)), total_(4 * modes_.size()) {
    validate(elastic, medium, rods);
    if (medium.closure == Closure::none)
        throw InputError("rates of a closure are requested in a medium without a closure");
}

std::span<double> ClosedRates::field(std::size_t rod) {
    return std::span(fields_).subspan(self_field_ ? 0 : rod * total_.size(), total_.size());
}

/// Headings' rates in the fields as they are.
void ClosedRates::turn(integrate::State poses, std::span<double> ydot) {
    const std::size_t numbers = total_.size();
    std::copy_n(fields_.begin(), numbers, total_.begin());
    for (std::size_t first = numbers; first < fields_.size(); first += numbers)
        for (std::size_t i = 0; i < numbers; ++i)
            total_[i] += fields_[first + i];
    const elastic::FieldRequest request = rods::request_of(couplings_, false);
    team_.run(poses.size() / 3, [&](std::size_t a) {
        const rods::Direction n = rods::direction(poses, a);
        const std::span<const double> own = self_field_ ? std::span<const double>() : field(a);
        const elastic::FieldValues values = modes_.at(poses[3 * a], poses[3 * a + 1], request, total_, own);
        ydot[3 * a + 2] = rods::turning_rate(values, couplings_, {n.cosine, n.sine});
    });
}

void ClosedRates::rates(integrate::State poses, std::span<double> ydot) {
    const std::size_t rods = poses.size() / 3;
    for (std::size_t a = 0; a < rods; ++a) {
        const rods::Direction n = rods::direction(poses, a);
        ydot[3 * a] = n.cosine;
        ydot[3 * a + 1] = n.sine;
        ydot[3 * a + 2] = 0.0;
    }
    if (!couplings_.any() || (rods < 2 && !self_field_))
        return;
    std::ranges::fill(fields_, 0.0);
    for (std::size_t b = 0; b < rods; ++b)
        modes_.add_steady(rods::pose(poses, b), field(b));
    turn(poses, ydot);
    if (!first_order_)
        return;
    for (std::size_t b = 0; b < rods; ++b)
        add_turning(modes_, rods::pose(poses, b), ydot[3 * b + 2], field(b));
    turn(poses, ydot);
}

rods::RodResult simulate_closed(const rods::RodProblem& rods, const DynamicMedium& medium,
                                rods::RodOptions options) {
    ClosedRates closed(*rods.medium, medium, rods.couplings, rods.rods.size(), rods.sums.threads);
    const rods::BodyForces bodies(rods.bodies, rods.rods.size(), rods.box);
    const rods::StateRates rates = [&](integrate::State y, std::span<double> ydot) {
        closed.rates(y, ydot);
        bodies.add_rates(y, ydot);
    };
    options.ode.method = integrate::Method::erk;
    return rods::simulate_rates(rods, rates, medium.force_width, options);
}

namespace {

/// -(across/z + i q_across along/z^2)/z for z = decay - i q_along: heading and wave vector along the rod and
/// across it.
Complex response(double decay, double q_along, double q_across, double along, double across) {
    const double norm = 1.0 / (decay * decay + q_along * q_along);
    const Complex inverse{decay * norm, q_along * norm}, square = inverse * inverse;
    return -1.0 * (square * (Complex{across, 0.0} + inverse * Complex{0.0, q_across * along}));
}

} // namespace

void add_turning(const ModalField& modes, const rods::Pose& rod, double rate, std::span<double> field) {
    const double nx = std::cos(rod.heading), ny = std::sin(rod.heading);
    const std::size_t size = modes.size(), columns = modes.columns();
    const PhaseFactors px = phases(modes.qx, -rod.x), py = phases(modes.qy, -rod.y);
    for (std::size_t i = 0; i < size; ++i) {
        if (modes.force[i] == 0.0)
            continue;
        const std::size_t row = i / columns, column = i % columns;
        const double qx = modes.qx[row], qy = modes.qy[column];
        const double ux = modes.unit_x[i], uy = modes.unit_y[i];
        const double q_along = qx * nx + qy * ny, q_across = qy * nx - qx * ny;
        const double along = ux * nx + uy * ny, across = uy * nx - ux * ny; // of q/|q|
        const Complex phase = Complex{px.re[row], px.im[row]} * Complex{py.re[column], py.im[column]};
        const Complex f = rate * modes.force[i] * phase;
        // n.(z x q/|q|) = -across, n'.(z x q/|q|) = along
        const Complex l = f * response(modes.decay_longitudinal[i], q_along, q_across, along, across);
        const Complex t = f * response(modes.decay_transverse[i], q_along, q_across, -across, along);
        field[i] += l.re;
        field[size + i] += l.im;
        field[2 * size + i] += t.re;
        field[3 * size + i] += t.im;
    }
}

} // namespace rodwake::medium
