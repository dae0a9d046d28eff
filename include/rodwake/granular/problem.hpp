#pragma once
// What a granular run models: beads and rods between two horizontal plates that vibrate in phase, periodic in
// x and y or within the wall of a container. SI units throughout. z points up, against gravity.

#include "rodwake/core/periodic.hpp"
#include "rodwake/granular/body_force.hpp"
#include "rodwake/granular/container.hpp"
#include "rodwake/granular/impact.hpp"
#include "rodwake/granular/shape.hpp"
#include "rodwake/granular/surfaces.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <vector>

namespace rodwake::granular {

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
    double bead_radius = 0.4e-3;        ///< a, m
    double bead_density = 2700.0;       ///< kg/m^3
    double gravity = 9.81;              ///< m/s^2; 0: none, with plates.gamma = 0 only
    PeriodicBox box = 78 * 0.4e-3;      ///< m; of a container: container->box()
    std::optional<Container> container; ///< absent: periodic
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

/// Sides of the bed, m: of the periodic box, or of the rectangle that its container fits into.
inline const PeriodicBox& bed_sides(const GranularProblem& problem) {
    return problem.container ? problem.container->sides : problem.box;
}

/// m^2.
double bed_area(const GranularProblem& problem);

/// Share N pi a^2/A of the beads alone in the area of the bed.
double bead_area_fraction(const GranularProblem& problem);

/// kg.
double bead_mass(const GranularProblem& problem);

/// round(time / step), not below `least`.
std::int64_t whole_steps(double time, double step, std::int64_t least = 0);

/// Throws InputError for what cannot be modelled: values outside their domain, a gap that a bead or rod does
/// not fit into, more beads than fit into the box beside the rods, rods that overlap.
void validate(const GranularProblem& problem);

} // namespace rodwake::granular
