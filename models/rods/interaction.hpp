#pragma once
// The turning rate one rod's wake gives another, as a function of where the other is in the first one's
// frame.

#include "rodwake/elastic/field.hpp"
#include "rodwake/rods/couplings.hpp"

namespace rodwake::rods {

/// Heading of the turned rod relative to the source rod, phi = theta_a - theta_b.
struct RelativeHeading {
    double cosine, sine;
};

/// z.[n x (kappa eps.n + gamma1 lap u + gamma2 grad div u)] with n = (cos phi, sin phi), all in the source's
/// frame. Unit: 1/time. `field` must hold strain if kappa != 0 and polar if a gamma != 0; the rest is not
/// read.
double turning_rate(const elastic::FieldValues& field, const Couplings& couplings, RelativeHeading heading);

/// The rate with its derivatives by the turned rod's place (x, y in the source's frame) and by phi.
struct TurningRate {
    double value, by_x, by_y, by_phi;
};
/// As turning_rate; `field` must hold the slopes too.
TurningRate turning_rate_derivatives(const elastic::FieldValues& field, const Couplings& couplings,
                                     RelativeHeading heading);

/// What the couplings need of the field; nothing more is evaluated.
elastic::Wanted wanted_by(const Couplings& couplings, bool slopes);

} // namespace rodwake::rods
