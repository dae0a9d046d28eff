#pragma once
// Numbers that must have the same bits in every build on every machine, as hashes of what they are after some
// steps: studies/validate_bits.py makes them with other compilers, flags and processors.

#include "rodwake/core/repeatable_math.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/granular/impact.hpp"
#include "rodwake/granular/simulation.hpp"
#include "rodwake/granular/start.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace rodwake::granular::fixed {

using Hashes = std::vector<std::pair<std::string, std::uint64_t>>;

class Bits {
public:
    void add(double number) { bits_.push_back(std::bit_cast<std::uint64_t>(number)); }
    std::uint64_t hash() const { return combined_hash(bits_); }

private:
    std::vector<std::uint64_t> bits_;
};

/// Of the elementary functions, arguments of all sizes.
inline std::uint64_t functions() {
    RandomStream random(1);
    Bits bits;
    for (int i = 0; i < 20000; ++i) {
        const double x = std::ldexp(random.uniform(-1.0, 1.0), i % 70 - 30);
        const auto [s, c] = repeatable::sin_cos(x);
        for (const double value :
             {s, c, repeatable::exp(std::remainder(x, 700.0)), repeatable::log(std::abs(x)),
              repeatable::atan2(x, s), repeatable::asin(c)})
            bits.add(value);
    }
    return bits.hash();
}

/// Of impacts with every kind of path, coupled as at the ends of rods.
inline std::uint64_t impacts() {
    RandomStream random(2);
    Bits bits;
    for (int i = 0; i < 3000; ++i) {
        const double x = random.uniform(-2.0, 2.0), y = random.uniform(-2.0, 2.0),
                     z = random.uniform(-2.0, 2.0);
        Eigen::Matrix3d inverse_mass;
        inverse_mass << 1.0 + x * x, x * y, x * z, x * y, 1.3 + y * y, y * z, x * z, y * z, 0.8 + z * z;
        const double vx = random.uniform(-1.0, 1.0), vy = random.uniform(-1.0, 1.0), vz = -random.uniform();
        const double friction = random.uniform(0.0, 0.6), restitution = random.uniform();
        const Impact impact = stronge_impact(inverse_mass, {vx, vy, vz}, {friction, restitution});
        for (const double value : impact.impulse)
            bits.add(value);
    }
    return bits.hash();
}

inline RodSpec rod(double x, double y, double heading) {
    RodSpec spec;
    spec.position = {x, y};
    spec.heading = heading;
    return spec;
}

/// A rectangle that beads start in at random, a tapered rod beside a symmetric one, and a force that moves.
inline GranularProblem periodic_bed() {
    GranularProblem problem;
    const double a = problem.bead_radius;
    problem.box = {26.0 * a, 24.0 * a};
    problem.beads = 120;
    problem.start = Start::random;
    problem.equilibration_steps = 40;
    problem.rods = {rod(13.0 * a, 10.0 * a, 0.4), rod(13.0 * a, 14.5 * a, 3.5)};
    problem.rods[1].shape.kind = RodKind::apolar;
    problem.rods[1].shape.taper = Taper::stepwise;
    problem.rods[1].shape.spheres = 13;
    problem.body_force = BodyForce{BodyForceKind::gaussian, 2.0, 0.7, 2.0 * a, 0.01, {}};
    return problem;
}

/// A dish with a turned lattice, a free rod and one that is pulled.
inline GranularProblem dish() {
    GranularProblem problem;
    const double a = problem.bead_radius;
    problem.container = Container{ContainerKind::circle, 40.0 * a, {0.2, 0.3}, {0.03, 0.1}};
    problem.box = problem.container->box();
    problem.beads = 250;
    problem.orientation = 0.3;
    problem.rods = {rod(14.0 * a, 24.0 * a, 2.0), rod(20.0 * a, 14.0 * a, -0.2)};
    problem.rods[1].imposed_speed = 2e-3;
    return problem;
}

/// From the start to 3000 steps, 0.3 s.
inline Hashes bed(const std::string& name, const GranularProblem& problem) {
    const State start = make_start(problem, 0);
    Hashes hashes{{name + ", start", state_hash(start)}};
    Simulation simulation(problem, start);
    for (const std::int64_t end : {1, 10, 100, 1000, 3000}) {
        simulation.advance(end - simulation.step());
        hashes.emplace_back(name + ", step " + std::to_string(simulation.step()),
                            state_hash(simulation.state()));
    }
    return hashes;
}

inline Hashes all() {
    Hashes hashes{{"functions", functions()}, {"impacts", impacts()}};
    for (const auto& more : {bed("periodic", periodic_bed()), bed("dish", dish())})
        hashes.insert(hashes.end(), more.begin(), more.end());
    return hashes;
}

} // namespace rodwake::granular::fixed
