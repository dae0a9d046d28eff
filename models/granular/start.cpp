#include "rodwake/granular/start.hpp"

#include "carve.hpp"

#include "rodwake/core/error.hpp"

#include <cmath>
#include <string>

#include <fmt/format.h>

namespace rodwake::granular {

namespace {

constexpr double height_margin = 1e-3; // of the free height stays free at both plates

Room room_of(const GranularProblem& problem) {
    const double free = 0.5 * problem.plates.gap - problem.bead_radius;
    Room room{problem.box, problem.bead_radius, (1.0 - height_margin) * free, {}};
    for (const RodSpec& rod : problem.rods)
        for (const Disc& disc : rod_discs(rod, make_clump(rod.shape)))
            room.rods.push_back(disc);
    return room;
}

/// Middle of the gap at step 0; t = 0 comes after the equilibration.
double middle_height(const GranularProblem& problem) {
    const double time = -static_cast<double>(problem.equilibration_steps) * problem.time_step;
    const double phase = 2.0 * M_PI * std::remainder(problem.plates.frequency * time, 1.0);
    return problem.plates.amplitude(problem.gravity) * std::cos(phase) + 0.5 * problem.plates.gap;
}

/// Two independent normal numbers (Box and Muller).
Eigen::Vector2d normal_pair(RandomStream& random) {
    const double radius = std::sqrt(-2.0 * std::log(random.uniform())), angle = 2.0 * M_PI * random.uniform();
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

void remove_mean(std::vector<double>& velocity) {
    double sum = 0.0;
    for (const double v : velocity)
        sum += v;
    for (double& v : velocity)
        v -= sum / static_cast<double>(velocity.size());
}

void set_velocities(Beads& beads, const GranularProblem& problem, std::uint32_t run) {
    for (std::size_t i = 0; i < beads.size(); ++i) {
        auto random = stream_for(Purpose::velocity, problem.seed, run, i);
        const Eigen::Vector2d in_plane = normal_pair(random), upwards = normal_pair(random);
        beads.vx[i] = problem.start_speed * in_plane.x();
        beads.vy[i] = problem.start_speed * in_plane.y();
        beads.vz[i] = problem.start_speed * upwards.x();
    }
    for (auto* velocity : {&beads.vx, &beads.vy, &beads.vz})
        remove_mean(*velocity);
}

RodBody resting_rod(const RodSpec& spec, double height) {
    RodBody rod;
    rod.position = {spec.position.x(), spec.position.y(), height};
    const double half = 0.5 * std::remainder(spec.heading, 2.0 * M_PI);
    rod.orientation = Eigen::Quaterniond(std::cos(half), 0.0, 0.0, std::sin(half));
    return rod;
}

std::string no_packing(const GranularProblem& problem, double overlap) {
    const bool random = problem.start == Start::random;
    return fmt::format(
        "found no {} packing of {} beads (phi_b = {:.4f}) {}that is free of overlaps: the best one still "
        "overlaps by {:.2g} bead radii; {}use fewer beads or a larger box",
        random ? "random" : "lattice", problem.beads, bead_area_fraction(problem),
        problem.rods.empty() ? "" : fmt::format("beside {} rods ", problem.rods.size()),
        overlap / problem.bead_radius, random ? "try start = \"lattice\", or " : "");
}

Places packed(const GranularProblem& problem, std::uint32_t run) {
    const Room room = room_of(problem);
    Places places =
        problem.start == Start::lattice ? on_lattice(problem, room, run) : at_random(problem, room, run);
    const double left = push_apart(places, room, stream_for(Purpose::shake, problem.seed, run));
    if (left > 0.0)
        throw RunError(no_packing(problem, left));
    return places;
}

} // namespace

State make_start(const GranularProblem& problem, std::uint32_t run) {
    validate(problem);
    const double middle = middle_height(problem);
    State state;
    if (problem.beads > 0) {
        const Places places = packed(problem, run);
        state.beads.resize(problem.beads);
        for (std::size_t i = 0; i < problem.beads; ++i) {
            state.beads.x[i] = wrap(places.x[i], problem.box);
            state.beads.y[i] = wrap(places.y[i], problem.box);
            state.beads.z[i] = middle + places.z[i];
        }
        set_velocities(state.beads, problem, run);
    }
    for (const RodSpec& rod : problem.rods)
        state.rods.push_back(resting_rod(rod, middle));
    return state;
}

} // namespace rodwake::granular
