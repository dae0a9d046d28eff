#pragma once
// The granular tables of a scene, after units are resolved and every value is checked.
//
// The granular bed has its own scale: everything here is SI, whatever `units` says, and "a" in a string means
// granular.bead_radius. [scales] is not needed. What is absent and follows from other keys stays absent here.

#include "rodwake/granular/bead_kinds.hpp"
#include "rodwake/granular/body_force.hpp"
#include "rodwake/granular/container.hpp"
#include "rodwake/granular/shape.hpp"
#include "rodwake/granular/surfaces.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rodwake::scene {

enum class GranularStart { lattice, random, restart, file };

/// Of a pair of particles that differs from particle_particle; a key that is absent does not differ.
struct SurfaceChange {
    std::optional<double> friction, restitution;

    bool operator==(const SurfaceChange&) const = default;
};

/// [granular.contacts]. Walls are the plates.
struct Contacts {
    granular::Surface particle_particle{0.05, 0.3}, rod_wall{0.03, 0.1}, bead_wall{0.2, 0.3};
    std::optional<SurfaceChange> bead_bead, bead_rod, rod_rod;

    bool operator==(const Contacts&) const = default;
};

/// [granular.output]
struct GranularOutput {
    std::optional<double> frames; ///< interval, s; absent: duration / 100
    std::optional<double> table;  ///< interval, s; absent: 0.01 s
    /// Of the frames: "h5md", "xyz", "xyz_if_short"; empty: no frames.
    std::vector<std::string> formats = {"h5md", "xyz_if_short"};
    long every_bead = 1;           ///< of the beads in frames: numbers 0, every_bead, 2 every_bead, ...
    bool last_period = true;       ///< about 50 frames of one plate period at the end
    double checkpoint = 30.0;      ///< wall-clock interval, s
    std::optional<double> archive; ///< interval of states that are kept, s; absent: none are

    bool operator==(const GranularOutput&) const = default;
};

/// [[granular.rods]]
struct GranularRod {
    granular::RodShape shape; ///< spheres and thick_diameter of an apolar rod: 13 and 0.95e-3 if not given
    std::vector<double> position;        ///< x, y of the centre of mass, m
    double heading = 0.0;                ///< of the thin end, rad, counter-clockwise from +x
    std::optional<double> imposed_speed; ///< m/s along the heading, held; 0: pinned; absent: free

    bool operator==(const GranularRod&) const = default;
};

/// [granular.rods_random]: rods at random in the bed, in place of [[granular.rods]].
struct RandomBedRods {
    long count = 0;
    granular::RodKind kind = granular::RodKind::motile; ///< of the shape that its rods have by default
    double min_separation = 0.0; ///< between the surfaces of two rods, and of a rod and a wall, m
    double heading = 0.0;        ///< rad; headings are uniform within `spread` of it
    double spread = 3.14159265358979323846;
    long seed = 1;

    bool operator==(const RandomBedRods&) const = default;
};

/// granular.box, m.
struct BoxSize {
    double x = 0.0, y = 0.0;
    /// The rectangle that an unstrained lattice fills (lattice_box in granular/start.hpp): of about this
    /// size, x = y.
    bool fit = false;

    double shorter() const { return x < y ? x : y; }
    bool operator==(const BoxSize&) const = default;
};

/// [granular.container]: a vertical wall in place of the periodic box.
struct BedContainer {
    granular::ContainerKind kind = granular::ContainerKind::circle;
    std::optional<double> radius;                ///< of the circle, m
    std::vector<double> sides;                   ///< of the rectangle, m
    std::optional<double> friction, restitution; ///< absent: those of bead_wall and rod_wall

    bool operator==(const BedContainer&) const = default;
};

/// plates.gap as the scene gives it, m. It does not tell scenes apart: the gap that is used does.
struct GivenGap : std::optional<double> {
    bool operator==(const GivenGap&) const { return true; }
};

/// [granular]: beads and rods between two plates, periodic in x and y or within a wall.
struct Granular {
    std::optional<double> phi_b; ///< sum pi a_i^2/A, A the area of the bed; either this or beads
    std::optional<long> beads;
    /// Rods take the place of beads: N pi a^2 = phi_b L_x L_y - shadows of the rods.
    bool count_rod_area = true;
    double bead_radius = 0.4e-3;                ///< a, m
    double bead_density = 2700.0;               ///< kg/m^3
    std::vector<granular::BeadKind> bead_kinds; ///< empty: all beads have bead_radius
    double bead_spread = 0.0;                   ///< of the radii of a kind, over their mean
    double gravity = 9.81;                      ///< m/s^2
    BoxSize box;                                ///< the periodic box; 0: there is a container
    GranularStart start = GranularStart::lattice;
    std::string restart_from; ///< checkpoint file; with start = restart only
    std::string start_file; ///< CSV of the beads or film, in place of phi_b and beads; with start = file only
    std::optional<long> start_frame;   ///< of a film, from 0; absent: the last
    double orientation = 0.0;          ///< of the close-packed rows from +x, rad
    double start_speed = 0.02;         ///< m/s
    std::optional<double> time_step;   ///< s; absent: plates.longest_step()
    std::optional<double> equilibrate; ///< s; absent: depends on start and phi_b
    double duration = 0.0;             ///< s
    std::optional<double>
        stop_at_travel; ///< mean advance of the rods along their first headings, m; absent: to the end
    long seed = 1, runs = 1;
    double overlap_limit = 0.1;         ///< fraction of the radius
    std::optional<double> order_cutoff; ///< m; absent: 1.4 lattice spacings
    granular::Plates plates;            ///< with the gap that is used
    GivenGap gap;                       ///< absent: default_gap()
    Contacts contacts;
    std::optional<BedContainer> container;
    std::optional<granular::BodyForce> body_force;
    GranularOutput output;
    std::optional<RandomBedRods> rods_random;
    std::vector<GranularRod> rods; ///< with rods_random those it stands for

    bool operator==(const Granular&) const = default;
};

/// The shape of rods that the scene gives by their kind alone.
granular::RodShape default_shape(granular::RodKind kind);

/// The rods that bed.rods_random stands for; they depend on it, on the bed's sides and on its container.
/// Fewer than its count where there is no room, none without sides.
std::vector<GranularRod> random_bed_rods(const Granular& bed);

inline granular::BeadMix bead_mix(const Granular& bed) {
    return {bed.bead_radius, bed.bead_kinds, bed.bead_spread};
}

/// Gap between the plates where the scene gives none, m: the paper's, or wider where it would stop the
/// largest of beads of several sizes.
double default_gap(const Granular& bed);

/// granular.time_step, or the longest one that follows the bed on its plates, s.
double time_step(const Granular& bed);

} // namespace rodwake::scene
