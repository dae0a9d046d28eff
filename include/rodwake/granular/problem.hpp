#pragma once
// What a granular run models: beads and rods between two horizontal plates that vibrate in phase, periodic in
// x and y. SI units throughout. z points up, against gravity.

#include "rodwake/core/periodic.hpp"
#include "rodwake/granular/impact.hpp"
#include "rodwake/granular/shape.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <vector>

namespace rodwake::granular {

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

struct RodSpec {
    RodShape shape;
    Eigen::Vector2d position = Eigen::Vector2d::Zero(); ///< of the centre of mass, m
    double heading = 0.0;                               ///< of the thin end from +x, rad, counter-clockwise
    /// In-plane velocity along the heading that is held whatever hits the rod (0: pinned); the rod may still
    /// hop, pitch and roll, but not yaw. Absent: the rod moves freely.
    std::optional<double> imposed_speed;

    bool operator==(const RodSpec&) const = default;
};

enum class Start { lattice, random };

struct GranularProblem {
    std::size_t beads = 0;
    double bead_radius = 0.4e-3;   ///< a, m
    double bead_density = 2700.0;  ///< kg/m^3
    double gravity = 9.81;         ///< m/s^2
    PeriodicBox box = 78 * 0.4e-3; ///< m
    Plates plates;
    ContactTable contacts;
    std::vector<RodSpec> rods;
    std::optional<BodyForce> body_force; ///< on the beads, from t = 0 on
    Start start = Start::lattice;
    double orientation = 0.0;  ///< wanted angle of the close-packed rows from +x, rad
    double start_speed = 0.02; ///< rms of each velocity component of the beads at the start; rods: of hops
                               ///< and of their ends and sides, m/s
    double time_step = 1e-4;   ///< s; plates.longest_step() of these defaults
    std::int64_t equilibration_steps = 0; ///< before t = 0, rods held where they are
    std::int64_t steps = 0;               ///< from t = 0 on
    std::uint64_t seed = 1;
    double overlap_limit = 0.1; ///< the run stops if an overlap exceeds this fraction of the smaller radius
                                ///< (of a pair before t = 0: 0.5)

    bool operator==(const GranularProblem&) const = default;
};

/// Area fraction N pi a^2/(L_x L_y) of the beads alone.
double bead_area_fraction(const GranularProblem& problem);

/// kg.
double bead_mass(const GranularProblem& problem);

/// round(time / step), not below `least`.
std::int64_t whole_steps(double time, double step, std::int64_t least = 0);

/// Throws InputError for what cannot be modelled: values outside their domain, a gap that a bead or rod does
/// not fit into, more beads than fit into the box beside the rods, rods that overlap.
void validate(const GranularProblem& problem);

} // namespace rodwake::granular
