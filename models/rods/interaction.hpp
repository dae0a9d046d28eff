#pragma once
// The turning rate one rod's wake gives another, as a function of where the other is in the first one's
// frame.

#include "rodwake/elastic/field.hpp"
#include "rodwake/integrate/ode.hpp"
#include "rodwake/rods/couplings.hpp"

#include <cmath>

namespace rodwake::rods {

/// Heading of the turned rod relative to the source rod, phi = theta_a - theta_b.
struct RelativeHeading {
    double cosine, sine;
};

/// z.[n x (kappa eps.n + gamma1 lap u + gamma2 grad div u)] with n = (cos phi, sin phi), all in the source's
/// frame. Unit: 1/time. `field` must hold strain if kappa != 0 and polar if a gamma != 0; the rest is not
/// read.
double turning_rate(const elastic::FieldValues& field, const Couplings& couplings, RelativeHeading heading);

/// kappa eps.n + gamma1 lap u + gamma2 grad div u; `field` and n in one frame, n of any length.
elastic::Vector drive(const elastic::FieldValues& field, const Couplings& couplings, elastic::Vector n);

/// The rate with its derivatives by the turned rod's place (x, y in the source's frame) and by phi.
struct TurningRate {
    double value, by_x, by_y, by_phi;
};
/// As turning_rate; `field` must hold the gradients too.
TurningRate turning_rate_derivatives(const elastic::FieldValues& field, const Couplings& couplings,
                                     RelativeHeading heading);

/// What the couplings need of the field; nothing more is evaluated.
elastic::FieldRequest request_of(const Couplings& couplings, bool gradients);

struct Direction {
    double cosine, sine;
};

inline Direction direction(integrate::State y, std::size_t rod) {
    return {std::cos(y[3 * rod + 2]), std::sin(y[3 * rod + 2])};
}

/// Rod a as rod b sees it.
struct View {
    double x, y; ///< place of a in b's frame
    RelativeHeading heading;
};

inline View view(integrate::State y, std::size_t a, std::size_t b, Direction na, Direction nb) {
    const double dx = y[3 * a] - y[3 * b], dy = y[3 * a + 1] - y[3 * b + 1];
    return {nb.cosine * dx + nb.sine * dy,
            nb.cosine * dy - nb.sine * dx,
            {na.cosine * nb.cosine + na.sine * nb.sine, na.sine * nb.cosine - na.cosine * nb.sine}};
}

} // namespace rodwake::rods
