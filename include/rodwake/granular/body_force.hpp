#pragma once
// A force on the beads in the plane that no rod and no plate exerts: the clean test of how the bed answers.
// From t = 0 on. Each bead of mass m feels m b(r, t) n, with n = (cos direction, sin direction) fixed and
//
//   uniform    b = acceleration
//   gaussian   b = acceleration exp(-|r - R(t)|^2 / (2 width^2)),  R(t) = place + speed t n
//
// r - R is the nearest image in the periodic box; width is at most a tenth of its shorter side, so what the
// other images would add is below 4e-6 of the peak. Heights, spins and rods feel nothing. SI throughout.
//
// Each step is: half a kick b dt/2 where the beads are, the step's flights and impacts, half a kick where
// they are then (velocity Verlet). Exact for a uniform force between impacts; else the error of positions and
// velocities is of order dt^2. In a bed of n beads an area, the total force of the Gaussian is about
// 2 pi width^2 n m acceleration.

#include "rodwake/core/periodic.hpp"

#include <vector>

namespace rodwake::granular {

enum class BodyForceKind { uniform, gaussian };

struct BodyForce {
    BodyForceKind kind = BodyForceKind::uniform;
    double acceleration = 0.0;      ///< along `direction`, of the peak if gaussian, m/s^2
    double direction = 0.0;         ///< of n from +x, rad, counter-clockwise
    double width = 0.0;             ///< m, gaussian only
    double speed = 0.0;             ///< of the Gaussian along n, m/s; negative: against the force
    std::vector<double> place = {}; ///< of the Gaussian at t = 0, x and y, m; empty: middle of the box

    /// b at a place and time, m/s^2. Any place, t >= 0.
    double at(double x, double y, double time, const PeriodicBox& box) const;

    bool operator==(const BodyForce&) const = default;
};

} // namespace rodwake::granular
