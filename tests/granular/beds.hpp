#pragma once
// Small problems and states made by hand.

#include "granular/bodies.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/granular/simulation.hpp"
#include "rodwake/granular/start.hpp"

namespace rodwake::granular::beds {

/// Every kind of contact alike.
inline void set_contacts(GranularProblem& problem, const Surface& surface) {
    problem.contacts = {surface, surface, surface, surface, surface};
}

/// Static plates, no beads yet; a short step, and guards that only stop nonsense.
inline GranularProblem still_plates(double gap, const PeriodicBox& box) {
    GranularProblem problem;
    problem.plates = {gap, 200.0, 0.0};
    problem.time_step = 2e-5; // what is made by hand moves faster than a bed does
    problem.box = box;
    problem.overlap_limit = 1.0;
    return problem;
}

/// A rod short enough for a box of 8 bead radii.
inline RodSpec short_rod(double x, double y, double heading) {
    RodSpec rod;
    rod.shape.length = 1.8e-3;
    rod.shape.thick_diameter = 1.0e-3;
    rod.shape.spheres = 4;
    rod.position = {x, y};
    rod.heading = heading;
    return rod;
}

inline RodSpec long_rod(double x, double y, double heading) {
    RodSpec rod;
    rod.position = {x, y};
    rod.heading = heading;
    return rod;
}

inline State one_bead(double z, double vz) {
    State state;
    state.beads.resize(1);
    state.beads.z[0] = z;
    state.beads.vz[0] = vz;
    return state;
}

inline Eigen::Vector3d random_vector(RandomStream& random, double size) {
    const double x = random.uniform(-size, size), y = random.uniform(-size, size);
    return {x, y, random.uniform(-size, size)};
}

inline Eigen::Quaterniond random_turn(RandomStream& random) {
    const Eigen::Vector3d v = random_vector(random, 1.0);
    return Eigen::Quaterniond(random.uniform(-1.0, 1.0), v.x(), v.y(), v.z()).normalized();
}

/// Centres of all spheres, beads first, and their radii, from the state alone.
inline Bodies bodies_of(const Simulation& simulation) {
    return make_bodies(simulation.problem(), simulation.state());
}

/// Pairs that overlap, by asking all of them; (first, second) in order.
inline std::vector<std::pair<std::size_t, std::size_t>> all_overlaps(const Bodies& b,
                                                                     const PeriodicBox& box) {
    std::vector<std::pair<std::size_t, std::size_t>> found;
    for (std::size_t i = 0; i < b.spheres(); ++i)
        for (std::size_t j = i + 1; j < b.spheres(); ++j) {
            if (i >= b.beads && b.rod_of[i - b.beads] == b.rod_of[j - b.beads])
                continue;
            double d2 = 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                double d = b.position[4 * i + k] - b.position[4 * j + k];
                if (const double side = k == 0 ? box.x : box.y; k < 2)
                    d -= side * std::round(d / side);
                d2 += d * d;
            }
            if (d2 < (b.radius[i] + b.radius[j]) * (b.radius[i] + b.radius[j]))
                found.emplace_back(i, j);
        }
    return found;
}

} // namespace rodwake::granular::beds
