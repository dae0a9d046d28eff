#include "rodwake/app/granular.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/granular/observe.hpp"
#include "rodwake/granular/start.hpp"
#include "start_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::app {

namespace {

granular::Surface surface(const granular::Surface& common,
                          const std::optional<scene::SurfaceChange>& change) {
    if (!change)
        return common;
    return {change->friction.value_or(common.friction), change->restitution.value_or(common.restitution)};
}

std::optional<granular::Container> container_of(const scene::Granular& bed) {
    if (!bed.container)
        return {};
    const scene::BedContainer& wall = *bed.container;
    const scene::SurfaceChange change{wall.friction, wall.restitution};
    const PeriodicBox sides = wall.kind == granular::ContainerKind::circle
                                  ? PeriodicBox(2.0 * *wall.radius)
                                  : PeriodicBox(wall.sides[0], wall.sides[1]);
    return granular::Container{wall.kind, sides, surface(bed.contacts.bead_wall, change),
                               surface(bed.contacts.rod_wall, change)};
}

double shadows_of(const scene::Granular& bed) {
    double shadows = 0.0;
    for (std::size_t i = 0; i < bed.rods.size(); ++i) {
        // Area of the shadow of a rod; what is no rod is named as validate() would.
        try {
            shadows += granular::make_clump(bed.rods[i].shape).projected_area();
        } catch (const InputError& error) {
            throw InputError(fmt::format("rod {}: {}", i, error.what()));
        }
    }
    return shadows;
}

/// N of N pi a^2 = phi_b A, from which the shadows of the rods are taken off if they count.
std::size_t bead_count(const scene::Granular& bed, double area) {
    if (bed.beads)
        return static_cast<std::size_t>(*bed.beads);
    if (!bed.phi_b) // those of start_file
        return 0;
    const double wanted = *bed.phi_b * area;
    const double shadows = bed.count_rod_area ? shadows_of(bed) : 0.0;
    if (shadows > wanted)
        throw InputError(fmt::format(
            "phi_b = {} with count_rod_area leaves no room for beads: the rods alone cover {:.4f} "
            "of the bed; raise phi_b or the bed's size, or set count_rod_area = false",
            *bed.phi_b, shadows / area));
    const double radius = scene::bead_mix(bed).root_mean_square(),
                 count = std::round((wanted - shadows) / (std::numbers::pi * radius * radius));
    constexpr double most = 1e7; // as for the key beads
    if (count > most)
        throw InputError(fmt::format("phi_b = {} on {:.4g} m^2 is {:.3g} beads; at most {:g}", *bed.phi_b,
                                     area, count, most));
    return static_cast<std::size_t>(count);
}

/// The lattice's sites are those that a start asks for: beads, and what the rods cover, as dense.
BedSize fitted_size(const scene::Granular& bed) {
    const double size = bed.box.x * bed.box.x, covered = shadows_of(bed);
    const auto beads = static_cast<double>(bead_count(bed, size));
    if (!(2.0 * covered < size) || !(beads >= 1.0))
        throw InputError(
            "box = \"fit\" needs more room for beads than for rods: give a larger size, \"fit 155 a\"");
    const double sites = beads * size / (size - covered);
    if (bed.beads) {
        const auto least = static_cast<long>(std::ceil(sites * (1.0 - 1e-9)));
        const auto fit = with_area(granular::lattice_box(sites, least, bed.orientation), size);
        return {fit.box, static_cast<std::size_t>(*bed.beads), fit};
    }
    // S = N A/(A - covered) with N pi a^2 = phi_b A - counted, solved for A
    const auto shape = granular::lattice_box(sites, 1, bed.orientation);
    const double radius = scene::bead_mix(bed).root_mean_square(), bead = std::numbers::pi * radius * radius,
                 counted = bed.count_rod_area ? covered : 0.0,
                 lattice = static_cast<double>(shape.sites()) * bead, sum = counted + lattice,
                 area = (sum + std::sqrt(std::max(sum * sum - 4.0 * *bed.phi_b * lattice * covered, 0.0))) /
                        (2.0 * *bed.phi_b);
    const auto fit = with_area(shape, area);
    return {fit.box, static_cast<std::size_t>((*bed.phi_b * area - counted) / bead + 1e-6), fit};
}

granular::Start start_of(const scene::Granular& bed) {
    if (bed.start == scene::GranularStart::file)
        return granular::Start::given;
    return bed.start == scene::GranularStart::random ? granular::Start::random : granular::Start::lattice;
}

granular::GranularProblem translate(const scene::Granular& bed, const std::string& path) {
    granular::GranularProblem problem;
    for (const scene::GranularRod& rod : bed.rods)
        problem.rods.push_back(
            granular::RodSpec{rod.shape, {rod.position[0], rod.position[1]}, rod.heading, rod.imposed_speed});
    const BedSize size = bed_size(bed);
    problem.beads = size.beads;
    problem.bead_radius = bed.bead_radius;
    problem.bead_kinds = bed.bead_kinds;
    problem.bead_spread = bed.bead_spread;
    problem.bead_density = bed.bead_density;
    problem.gravity = bed.gravity;
    problem.box = size.box;
    problem.container = container_of(bed);
    if (bed.start == scene::GranularStart::file) {
        problem.given = read_start_file(bed, path);
        problem.beads = problem.given->x.size();
    }
    if (bed.bead_spread > 0.0 && bed.phi_b && problem.beads > 0)
        problem.bead_area =
            *bed.phi_b * granular::bed_area(problem) - (bed.count_rod_area ? shadows_of(bed) : 0.0);
    problem.plates = bed.plates;
    const granular::Surface& common = bed.contacts.particle_particle;
    problem.contacts = granular::ContactTable{
        surface(common, bed.contacts.bead_bead), surface(common, bed.contacts.bead_rod),
        surface(common, bed.contacts.rod_rod), bed.contacts.bead_wall, bed.contacts.rod_wall};
    problem.body_force = bed.body_force;
    problem.start = start_of(bed);
    problem.orientation = bed.orientation;
    problem.start_speed = bed.start_speed;
    problem.time_step = scene::time_step(bed);
    const double phi_b = bed.phi_b.value_or(granular::bead_area_fraction(problem));
    problem.equilibration_steps = granular::whole_steps(equilibration_time(bed, phi_b), problem.time_step);
    problem.steps = granular::whole_steps(bed.duration, problem.time_step, 1);
    problem.seed = static_cast<std::uint64_t>(bed.seed);
    problem.overlap_limit = bed.overlap_limit;
    return problem;
}

} // namespace

granular::GranularProblem granular_problem(const scene::Scene& scene) {
    if (!scene.granular)
        throw InputError(scene.path + ": no [granular] table, so there is no bed to simulate");
    try {
        granular::GranularProblem problem = translate(*scene.granular, scene.path);
        granular::validate(problem);
        if (problem.given)
            granular::make_start(problem, 0); // beads that overlap are refused before anything is written
        return problem;
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: [granular] {}", scene.path, error.what()));
    }
}

BedSize bed_size(const scene::Granular& bed) {
    if (bed.box.fit)
        return fitted_size(bed);
    if (const auto container = container_of(bed))
        return {container->box(), bead_count(bed, container->area()), {}};
    const PeriodicBox box{bed.box.x, bed.box.y};
    return {box, bead_count(bed, box.x * box.y), {}};
}

double equilibration_time(const scene::Granular& bed, double phi_b) {
    if (bed.equilibrate)
        return *bed.equilibrate;
    if (bed.start == scene::GranularStart::restart)
        return 0.0;
    return granular::settling_time(start_of(bed), phi_b);
}

std::optional<double> order_cutoff(const scene::Granular& bed, double phi_b) {
    if (bed.order_cutoff || !(phi_b > 0.0))
        return bed.order_cutoff;
    return granular::neighbour_cutoff(scene::bead_mix(bed).root_mean_square(), phi_b);
}

double spheres(const granular::GranularProblem& problem) {
    auto count = static_cast<double>(problem.beads);
    for (const granular::RodSpec& rod : problem.rods)
        count += static_cast<double>(rod.shape.spheres);
    return count;
}

double sphere_steps(const granular::GranularProblem& problem) {
    return spheres(problem) * static_cast<double>(problem.equilibration_steps + problem.steps);
}

double frame_interval(const scene::Granular& bed) { return bed.output.frames.value_or(bed.duration / 100.0); }

double table_interval(const scene::Granular& bed) { return bed.output.table.value_or(0.01); }

double frame_count(const scene::Granular& bed) {
    return std::floor(bed.duration / frame_interval(bed)) + 1.0;
}

double xyz_bytes(const scene::Granular& bed, const granular::GranularProblem& problem) {
    constexpr double line = 140.0; // seven numbers of up to 19 characters and what is short
    return line * stored_spheres(bed, problem) * frame_count(bed);
}

double stored_spheres(const scene::Granular& bed, const granular::GranularProblem& problem) {
    const auto beads = static_cast<double>(problem.beads);
    return spheres(problem) - beads + std::ceil(beads / static_cast<double>(bed.output.every_bead));
}

GranularSchedule granular_schedule(const scene::Granular& bed, const granular::GranularProblem& problem) {
    constexpr double short_run = 25e6; // bytes; the paper's box with the usual 101 frames has 22e6
    const auto wants = [&](const char* format) { return std::ranges::count(bed.output.formats, format) > 0; };
    const bool is_short = static_cast<double>(bed.runs) * xyz_bytes(bed, problem) < short_run;
    return {order_cutoff(bed, granular::bead_area_fraction(problem)).value_or(0.0),
            granular::whole_steps(table_interval(bed), problem.time_step, 1),
            granular::whole_steps(frame_interval(bed), problem.time_step, 1),
            bed.stop_at_travel.value_or(0.0),
            wants("h5md"),
            wants("xyz") || (wants("xyz_if_short") && is_short),
            bed.output.last_period,
            static_cast<std::size_t>(bed.output.every_bead),
            bed.output.archive ? granular::whole_steps(*bed.output.archive, problem.time_step, 1) : 0};
}

} // namespace rodwake::app
