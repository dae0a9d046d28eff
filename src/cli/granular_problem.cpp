#include "granular_problem.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::cli {

namespace {

granular::Surface surface(const scene::Surface& s) { return {s.friction, s.restitution}; }

granular::Surface surface(const scene::Surface& common, const std::optional<scene::SurfaceChange>& change) {
    if (!change)
        return surface(common);
    return {change->friction.value_or(common.friction), change->restitution.value_or(common.restitution)};
}

granular::ContactTable contact_table(const scene::Contacts& c) {
    const scene::Surface& common = c.particle_particle;
    return {surface(common, c.bead_bead), surface(common, c.bead_rod), surface(common, c.rod_rod),
            surface(c.bead_wall), surface(c.rod_wall)};
}

granular::RodShape shape_of(const scene::GranularRod& rod) {
    return {rod.kind == scene::RodKind::apolar ? granular::RodKind::apolar : granular::RodKind::motile,
            rod.taper == scene::RodTaper::stepwise ? granular::Taper::stepwise : granular::Taper::linear,
            rod.length,
            rod.thick_diameter,
            rod.thin_diameter,
            rod.density,
            static_cast<std::size_t>(rod.spheres),
            static_cast<std::size_t>(rod.segments)};
}

granular::RodSpec rod_spec(const scene::GranularRod& rod) {
    return {shape_of(rod), {rod.position[0], rod.position[1]}, rod.heading, rod.imposed_speed};
}

/// Area of the shadow of a rod; what is no rod is named as validate() would.
double shadow(const granular::RodShape& shape, std::size_t index) {
    try {
        return granular::make_clump(shape).shadow();
    } catch (const InputError& error) {
        throw InputError(fmt::format("rod {}: {}", index, error.what()));
    }
}

/// N of N pi a^2 = phi_b L^2, from which the shadows of the rods are taken off if they count.
std::size_t bead_count(const scene::Granular& bed, const std::vector<granular::RodSpec>& rods) {
    if (bed.beads)
        return static_cast<std::size_t>(*bed.beads);
    const double wanted = *bed.phi_b * bed.box * bed.box;
    double shadows = 0.0;
    for (std::size_t i = 0; i < rods.size(); ++i)
        shadows += bed.count_rod_area ? shadow(rods[i].shape, i) : 0.0;
    if (shadows > wanted)
        throw InputError(fmt::format(
            "phi_b = {} with count_rod_area leaves no room for beads: the rods alone cover {:.4f} "
            "of the box; raise phi_b or the box, or set count_rod_area = false",
            *bed.phi_b, shadows / (bed.box * bed.box)));
    const double count =
        std::round((wanted - shadows) / (std::numbers::pi * bed.bead_radius * bed.bead_radius));
    constexpr double most = 1e7; // as for the key beads
    if (count > most)
        throw InputError(fmt::format("phi_b = {} in a box of {} m is {:.3g} beads; at most {:g}", *bed.phi_b,
                                     bed.box, count, most));
    return static_cast<std::size_t>(count);
}

granular::GranularProblem translate(const scene::Granular& bed, std::optional<std::uint64_t> seed_override) {
    granular::GranularProblem problem;
    for (const scene::GranularRod& rod : bed.rods)
        problem.rods.push_back(rod_spec(rod));
    problem.beads = bead_count(bed, problem.rods);
    problem.bead_radius = bed.bead_radius;
    problem.bead_density = bed.bead_density;
    problem.gravity = bed.gravity;
    problem.box = bed.box;
    problem.plates = {bed.plates.gap, bed.plates.frequency, bed.plates.gamma};
    problem.contacts = contact_table(bed.contacts);
    problem.start =
        bed.start == scene::GranularStart::random ? granular::Start::random : granular::Start::lattice;
    problem.orientation = bed.orientation;
    problem.start_speed = bed.start_speed;
    problem.time_step = bed.time_step;
    const double phi_b = bed.phi_b.value_or(granular::bead_area_fraction(problem));
    problem.equilibration_steps = whole_steps(equilibration_time(bed, phi_b), bed.time_step);
    problem.steps = whole_steps(bed.duration, bed.time_step, 1);
    problem.seed = seed_override.value_or(static_cast<std::uint64_t>(bed.seed));
    problem.overlap_limit = bed.overlap_limit;
    return problem;
}

} // namespace

granular::GranularProblem granular_problem(const scene::Scene& scene,
                                           std::optional<std::uint64_t> seed_override) {
    if (!scene.granular)
        throw InputError(scene.path + ": no [granular] table, so there is no bed to simulate");
    try {
        const granular::GranularProblem problem = translate(*scene.granular, seed_override);
        granular::validate(problem);
        return problem;
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: [granular] {}", scene.path, error.what()));
    }
}

std::int64_t whole_steps(double time, double step, std::int64_t least) {
    return std::max(least, static_cast<std::int64_t>(std::llround(time / step)));
}

double equilibration_time(const scene::Granular& bed, double phi_b) {
    if (bed.equilibrate)
        return *bed.equilibrate;
    if (bed.start != scene::GranularStart::random)
        return bed.start == scene::GranularStart::lattice ? 0.5 : 0.0;
    struct Knot {
        double phi_b, time;
    };
    static constexpr std::array knots{Knot{0.60, 1.0}, Knot{0.70, 2.0}, Knot{0.72, 8.0}, Knot{0.76, 10.0},
                                      Knot{0.80, 24.0}};
    for (std::size_t i = 1; i < knots.size(); ++i)
        if (phi_b < knots[i].phi_b) {
            const Knot &a = knots[i - 1], &b = knots[i];
            const double part = std::max(0.0, (phi_b - a.phi_b) / (b.phi_b - a.phi_b));
            return a.time + part * (b.time - a.time);
        }
    return knots.back().time;
}

std::optional<double> order_cutoff(const scene::Granular& bed, double phi_b) {
    if (bed.order_cutoff || !(phi_b > 0.0))
        return bed.order_cutoff;
    return 1.4 * 2.0 * bed.bead_radius * std::sqrt(0.9069 / phi_b);
}

double frame_interval(const scene::Granular& bed) { return bed.output.frames.value_or(bed.duration / 100.0); }

double table_interval(const scene::Granular& bed) { return bed.output.table.value_or(0.01); }

} // namespace rodwake::cli
