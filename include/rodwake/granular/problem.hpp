#pragma once
// What a granular run models: beads and rods between two horizontal plates that vibrate in phase, periodic in
// x and y or within the wall of a container. SI units throughout. z points up, against gravity.

#include "rodwake/core/periodic.hpp"
#include "rodwake/granular/bead_kinds.hpp"
#include "rodwake/granular/body_force.hpp"
#include "rodwake/granular/container.hpp"
#include "rodwake/granular/impact.hpp"
#include "rodwake/granular/shape.hpp"
#include "rodwake/granular/surfaces.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>
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

/// Beads that start where a file says. Columns of one length; an empty one is drawn as for other starts.
struct GivenBeads {
    std::vector<double> x, y;       ///< m
    std::vector<double> z;          ///< above the mean height of the floor, m
    std::vector<double> vx, vy, vz; ///< m/s
    std::vector<double> radius;     ///< m
    std::vector<std::uint8_t> kind; ///< not empty if there are radii and several kinds

    bool operator==(const GivenBeads&) const = default;
};

enum class Start { lattice, random, given };

struct GranularProblem {
    std::size_t beads = 0;
    double bead_radius = 0.4e-3;        ///< a, m: the unit of length, and the radius of beads without kinds
    std::vector<BeadKind> bead_kinds;   ///< empty: one
    double bead_spread = 0.0;           ///< of the radii of a kind (BeadMix)
    double bead_area = 0.0;             ///< that radii of a spread are scaled to cover, m^2; 0: as without it
    double bead_density = 2700.0;       ///< kg/m^3
    double gravity = 9.81;              ///< m/s^2; 0: none, with plates.gamma = 0 only
    PeriodicBox box = 78 * 0.4e-3;      ///< m; of a container: container->box()
    std::optional<Container> container; ///< absent: periodic
    Plates plates;
    ContactTable contacts;
    std::vector<RodSpec> rods;
    std::optional<BodyForce> body_force; ///< on the beads, from t = 0 on
    Start start = Start::lattice;
    std::optional<GivenBeads> given; ///< with Start::given: as many as `beads`
    double orientation = 0.0;        ///< wanted angle of the close-packed rows from +x, rad
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

inline BeadMix bead_mix(const GranularProblem& problem) {
    return {problem.bead_radius, problem.bead_kinds, problem.bead_spread};
}

/// Radius of each bead, m, and its kind.
struct BeadSizes {
    std::vector<double> radius;
    std::vector<std::uint8_t> kind;
};

/// Given ones, the others drawn from streams of (seed, run), each bead on its own. With a spread the squares
/// of drawn radii sum to bead_area/pi, or to what they do without it. Throws InputError if a bead is larger
/// than the gap, or a given radius not one of its kind.
BeadSizes bead_sizes(const GranularProblem& problem, std::uint32_t run);

/// Throws InputError, which begins with `what`, if the kind of one of these beads is none of the mix, or its
/// radius is not within two deviations of that of its kind; 1.1 times more for the common factor of a spread.
void require_sizes(const BeadMix& mix, const BeadSizes& sizes, const char* what);

/// How many beads are of each kind.
std::vector<std::size_t> kind_counts(const GranularProblem& problem);

/// Share sum pi a_i^2/A of the beads alone in the area of the bed.
double bead_area_fraction(const GranularProblem& problem);
/// The same of beads with these radii, m: after a restart those that are left need not have the shares of
/// the kinds. Where all beads are equal, or there are no radii, as above.
double bead_area_fraction(const GranularProblem& problem, std::span<const double> radii);

/// The mass of a bead of this radius, m, or of radius a, in kg.
double bead_mass(const GranularProblem& problem, double radius);
inline double bead_mass(const GranularProblem& problem) { return bead_mass(problem, problem.bead_radius); }
/// Mean over the beads, a spread aside, kg.
double mean_bead_mass(const GranularProblem& problem);

/// round(time / step), not below `least`.
std::int64_t whole_steps(double time, double step, std::int64_t least = 0);

/// Throws InputError for what cannot be modelled: values outside their domain, a gap that a bead or rod does
/// not fit into, more beads than fit into the box beside the rods, rods that overlap.
void validate(const GranularProblem& problem);

} // namespace rodwake::granular
