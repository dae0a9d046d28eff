#pragma once
// Moves beads that overlap apart until none does: between two plates, beside rods that stay, periodic in x
// and y or within the wall of a container.

#include "rodwake/core/rng.hpp"
#include "rodwake/granular/problem.hpp"
#include "rodwake/granular/start.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace rodwake::granular {

// Plan view of the box: rods lying flat are rows of discs on a periodic plane.

struct Disc {
    double x, y, radius; ///< m
    double height = 0.0; ///< of the centre above the middle of the gap, m; no part of the plan view
};

/// Sphere centres of a rod as it starts, from the thick to the thin end.
std::vector<Disc> rod_discs(const RodSpec& rod, const Clump& clump);

/// Largest depth by which discs of the two rows overlap, m; negative: the gap between them.
double overlap(const std::vector<Disc>& first, const std::vector<Disc>& second, const PeriodicBox& box);

/// Where beads may be. z = 0 is the middle of the gap; rods lie there, but for a little (Disc::height).
struct Room {
    PeriodicBox box;        ///< m
    double radius;          ///< of the smallest beads, m: the scale of steps
    double gap;             ///< between the plates, m
    std::vector<Disc> rods; ///< spheres of all rods
    std::optional<Container> container = {};
};

/// The centre of a bead of this radius keeps to |z| <= that, m; a thousandth of it stays free at both plates.
inline double free_height(double gap, double radius) { return (1.0 - 1e-3) * (0.5 * gap - radius); }

struct BeadPositions {
    std::vector<double> x, y, z;    ///< m
    std::vector<double> radius;     ///< m
    std::vector<std::uint8_t> kind; ///< number of the bead's kind

    std::size_t size() const { return x.size(); }
    void add(double to_x, double to_y, double to_z, double of_radius, std::uint8_t of_kind);
};

/// Beads with less than this share of free distance, of two radii, count as overlapping.
inline constexpr double separation = 1e-6;

/// Moves overlapping beads, in turn and always in the same order, and shakes them if that does not end.
/// Returns the largest remaining overlap, m: 0 if nothing overlaps, more if no packing was found.
double push_apart(BeadPositions& places, const Room& room, RandomStream random);

// First places of the beads, before they are pushed apart.

/// What the random numbers of a start are for; each purpose has streams of its own.
enum class Purpose : std::uint64_t { place = 1, vacancy, velocity, shake, rod, kind, radius };

/// Stream of one bead or site: independent of all others and of how many there are.
RandomStream stream_for(Purpose purpose, std::uint64_t seed, std::uint32_t run, std::size_t index = 0);

/// Indices, in order, of `beads` of these sites. Sites under rods are dropped, the most covered first, then
/// sites at random; where the beads are dense, some that rods cover a little stay and have to give way.
/// `radius`: of the bead at each site; empty: room.radius.
std::vector<std::size_t> kept_sites(const std::vector<Eigen::Vector2d>& sites,
                                    const std::vector<double>& radius, const GranularProblem& problem,
                                    const Room& room, std::uint32_t run);

/// Beads of these sizes at these of the sites, at mid gap but for a little.
BeadPositions flat_layer(const std::vector<Eigen::Vector2d>& sites, const std::vector<std::size_t>& kept,
                         const BeadSizes& sizes, const GranularProblem& problem, const Room& room,
                         std::uint32_t run);

/// On the lattice that fits best; in a container on a perfect one, as wide as the beads allow.
BeadPositions on_lattice(const GranularProblem& problem, const Room& room, std::uint32_t run);

/// Uniform in the room outside the rods.
BeadPositions at_random(const GranularProblem& problem, const Room& room, std::uint32_t run);

/// fit.sites points in the box, exact to rounding, always in the same order; the first is (0, 0).
std::vector<Eigen::Vector2d> lattice_sites(const LatticeFit& fit, const PeriodicBox& box);

// Pairs of beads and of beads with rod spheres that are near each other in plan view.

/// Of beads by their places in Neighbours::order, and of spheres of rods by their numbers.
struct NearPair {
    std::uint32_t bead, other; ///< other: a bead, or a rod's sphere
};

struct NeighbourPairs {
    std::vector<std::uint32_t> order; ///< the beads, cell by cell: neighbours are near each other here too
    std::vector<NearPair> beads;      ///< each pair once
    std::vector<NearPair> rods;
};

/// All pairs whose surfaces are less than `skin` apart in plan view, in an order that depends on the places
/// only.
NeighbourPairs neighbours(const BeadPositions& places, const Room& room, double skin);

} // namespace rodwake::granular
