#include "rodwake/granular/problem.hpp"

#include "checks.hpp"
#include "fixed_order.hpp"
#include "packing.hpp"
#include "wall.hpp"

#include <algorithm>

namespace rodwake::granular {

namespace {

constexpr double closest_packing = 0.906899682117089; // pi/sqrt(12), equal discs on a plane
constexpr double least_steps_per_period = 8.0;
constexpr double least_box = 8.0;       // bead radii: a bead's neighbours are then distinct images
constexpr double image_clearance = 2.2; // bead radii between a rod and its own image: a bead passes
constexpr double furthest_rod = 1000.0; // boxes: beyond, wrapping loses digits
constexpr std::size_t most_beads = 100'000'000;
constexpr double widest_spread = 0.2;                      // the smallest bead is then 0.6 of the mean
constexpr std::int64_t most_steps = 1'000'000'000'000'000; // step * dt keeps its digits

void check_surface(std::string_view pair, const Surface& surface, Checks& checks) {
    checks.number(surface.friction >= 0.0, fmt::format("{} friction", pair), surface.friction,
                  ">= 0 and finite");
    checks.number(surface.restitution >= 0.0 && surface.restitution <= 1.0,
                  fmt::format("{} restitution", pair), surface.restitution, "between 0 and 1");
}

void check_sizes(const GranularProblem& problem, Checks& checks) {
    checks.positive("bead_radius", problem.bead_radius);
    checks.require(problem.bead_kinds.size() <= most_bead_kinds,
                   fmt::format("bead_kinds: {} of them: must be at most {}", problem.bead_kinds.size(),
                               most_bead_kinds));
    for (std::size_t k = 0; k < problem.bead_kinds.size(); ++k) {
        checks.positive(fmt::format("bead kind {}: radius", k), problem.bead_kinds[k].radius);
        checks.positive(fmt::format("bead kind {}: share", k), problem.bead_kinds[k].share);
    }
    constexpr double most_ratio =
        20.0; // cells are as wide as the largest: of smaller ones too many share one
    const auto [least, most] =
        std::ranges::minmax(problem.bead_kinds.empty() ? std::vector{BeadKind{1.0, 1.0}} : problem.bead_kinds,
                            {}, &BeadKind::radius);
    checks.require(
        most.radius <= most_ratio * least.radius,
        fmt::format("bead_kinds: radii from {:g} to {:g} m: the largest must be at most {} times the "
                    "smallest",
                    least.radius, most.radius, most_ratio));
    checks.number(problem.bead_spread >= 0.0 && problem.bead_spread <= widest_spread, "bead_spread",
                  problem.bead_spread, fmt::format("between 0 and {}", widest_spread));
    checks.number(problem.bead_area >= 0.0, "bead_area", problem.bead_area, ">= 0 and finite (m^2)");
}

void check_numbers(const GranularProblem& problem, Checks& checks) {
    checks.require(problem.beads > 0 || !problem.rods.empty(),
                   "no beads and no rods: must have at least one of them");
    checks.require(problem.beads <= most_beads,
                   fmt::format("beads = {}: must be at most {}", problem.beads, most_beads));
    check_sizes(problem, checks);
    checks.positive("bead_density", problem.bead_density);
    checks.sides(problem.box);
    checks.number(true, "orientation", problem.orientation, "finite (rad)");
    checks.number(problem.start_speed >= 0.0, "start_speed", problem.start_speed, ">= 0 and finite");
    checks.number(problem.overlap_limit > 0.0 && problem.overlap_limit <= 1.0, "overlap_limit",
                  problem.overlap_limit, "in (0, 1]");
    const ContactTable& contacts = problem.contacts;
    check_surface("bead-bead", contacts.bead_bead, checks);
    check_surface("bead-rod", contacts.bead_rod, checks);
    check_surface("rod-rod", contacts.rod_rod, checks);
    check_surface("bead-plate", contacts.bead_plate, checks);
    check_surface("rod-plate", contacts.rod_plate, checks);
    const Plates& plates = problem.plates;
    checks.positive("gap", plates.gap);
    checks.positive("frequency", plates.frequency);
    checks.number(plates.gamma >= 0.0, "gamma", plates.gamma, ">= 0 and finite (0: static plates)");
    checks.number(problem.gravity >= 0.0, "gravity", problem.gravity, ">= 0 and finite (m/s^2)");
    checks.require(problem.gravity != 0.0 || !(plates.gamma > 0.0),
                   fmt::format("gamma = {} with gravity = 0: gamma is the acceleration of the plates over "
                               "gravity, so without it they cannot move; must be 0 (static plates)",
                               plates.gamma));
    const bool sound = plates.frequency > 0.0 && plates.gamma >= 0.0 && problem.gravity >= 0.0;
    const double amplitude = plates.amplitude(problem.gravity);
    checks.require(
        !sound || std::isfinite(amplitude),
        fmt::format("amplitude gamma g/(2 pi f)^2 = {} m: must be finite; raise the frequency", amplitude));
    checks.positive("time_step", problem.time_step);
    for (const auto& [name, steps] :
         {std::pair{"equilibration_steps", problem.equilibration_steps}, std::pair{"steps", problem.steps}})
        checks.require(
            steps >= 0 && steps <= most_steps,
            fmt::format("{} = {}: must be 0 to {:g}", name, steps, static_cast<double>(most_steps)));
    const double per_period = 1.0 / (problem.plates.frequency * problem.time_step);
    checks.require(
        problem.plates.gamma == 0.0 || !(per_period < least_steps_per_period * (1.0 - 1e-9)),
        fmt::format("time_step = {} s is {:.3g} steps a period of the plates ({} Hz): must be at least {}, "
                    "that is time_step <= {:.3g} s",
                    problem.time_step, per_period, problem.plates.frequency, least_steps_per_period,
                    1.0 / (problem.plates.frequency * least_steps_per_period)));
}

/// Clumps of all rods, as far as they are rods.
std::vector<Clump> check_rods(const GranularProblem& problem, Checks& checks) {
    std::vector<Clump> clumps;
    for (std::size_t k = 0; k < problem.rods.size(); ++k) {
        const RodSpec& rod = problem.rods[k];
        const auto name = fmt::format("rod {}", k);
        checks.number(std::abs(rod.position.x()) <= furthest_rod * problem.box.x,
                      fmt::format("{}: position x", name), rod.position.x(),
                      fmt::format("within {} box lengths of 0", furthest_rod));
        checks.number(std::abs(rod.position.y()) <= furthest_rod * problem.box.y,
                      fmt::format("{}: position y", name), rod.position.y(),
                      fmt::format("within {} box lengths of 0", furthest_rod));
        checks.number(true, fmt::format("{}: heading", name), rod.heading, "finite (rad)");
        if (rod.imposed_speed)
            checks.number(true, fmt::format("{}: imposed_speed", name), *rod.imposed_speed, "finite (m/s)");
        try {
            clumps.push_back(make_clump(rod.shape));
        } catch (const InputError& error) {
            checks.require(false, fmt::format("{}: {}", name, error.what()));
        }
    }
    return clumps;
}

void check_box(const GranularProblem& problem, Checks& checks) {
    // a rod turns: its image along the shorter side is the near one
    const double a = bead_mix(problem).largest(), box = problem.box.shorter();
    if (problem.container)
        return; // no images
    checks.require(problem.beads == 0 || box >= least_box * a,
                   fmt::format("box = {} m: {}must be at least {} bead radii, {} m", box,
                               problem.box.square() ? "" : "its shorter side ", least_box, least_box * a));
    for (std::size_t k = 0; k < problem.rods.size(); ++k) {
        const double length = problem.rods[k].shape.length;
        checks.require(
            length + image_clearance * a < box,
            fmt::format(
                "rod {}: length = {} m in a periodic box of {} m leaves no room for a bead between the "
                "rod and its own image: the box must be larger than length + {} bead radii = {} m",
                k, length, box, image_clearance, length + image_clearance * a));
    }
}

/// Of a rod in the container, its discs moved by `way`.
void check_inside(const Container& container, const RodSpec& rod, const Clump& clump,
                  const Eigen::Vector2d& way, std::string_view what, Checks& checks) {
    double deepest = 0.0;
    for (const Disc& disc : rod_discs(rod, clump))
        deepest = std::max(deepest,
                           nearest_wall(container, Eigen::Vector2d(disc.x, disc.y) + way, disc.radius).depth);
    checks.require(deepest <= 0.0,
                   fmt::format("{} is {:.3g} m through the wall of the container, which spans "
                               "0 to {:g} m along x and 0 to {:g} m along y",
                               what, deepest, container.sides.x, container.sides.y));
}

void check_container(const GranularProblem& problem, const std::vector<Clump>& clumps, Checks& checks) {
    const Container& container = *problem.container;
    check_surface("container, bead-wall", container.beads, checks);
    check_surface("container, rod-wall", container.rods, checks);
    checks.require(problem.box == container.box(),
                   fmt::format("box = {} m, {} m: must be twice the sides of the container", problem.box.x,
                               problem.box.y));
    const double least = 4.0 * bead_mix(problem).largest();
    checks.require(container.sides.shorter() >= least,
                   fmt::format("container: its {} {} m must be at least 4 bead radii, {} m",
                               container.kind == ContainerKind::circle ? "diameter" : "shorter side",
                               container.sides.shorter(), least));
    checks.require(container.kind == ContainerKind::rectangle || container.sides.square(),
                   "container: a circle has one diameter");
    if (!checks.passed())
        return;
    const double time = static_cast<double>(problem.steps) * problem.time_step;
    for (std::size_t k = 0; k < clumps.size(); ++k) {
        const RodSpec& rod = problem.rods[k];
        check_inside(container, rod, clumps[k], {0.0, 0.0},
                     fmt::format("rod {}: move or turn it; its start", k), checks);
        if (const double way = time * rod.imposed_speed.value_or(0.0); way != 0.0 && checks.passed())
            check_inside(
                container, rod, clumps[k], way * direction(rod.heading),
                fmt::format("rod {}: shorten the duration or lower imposed_speed = {:g} m/s; its end", k,
                            *rod.imposed_speed),
                checks);
    }
}

void check_body_force(const GranularProblem& problem, Checks& checks) {
    if (!problem.body_force)
        return;
    const BodyForce& force = *problem.body_force;
    checks.require(!problem.container || force.kind == BodyForceKind::uniform,
                   "body_force: a gaussian moves through a periodic box; in a container use kind = "
                   "\"uniform\", or leave the container out");
    const double widest = 0.1 * problem.box.shorter();
    checks.require(problem.beads > 0, "body_force: acts on beads, and there are none");
    checks.number(true, "body_force: acceleration", force.acceleration, "finite (m/s^2)");
    checks.number(true, "body_force: direction", force.direction, "finite (rad)");
    if (force.kind == BodyForceKind::uniform)
        return;
    checks.number(force.width > 0.0 && force.width <= widest, "body_force: width", force.width,
                  fmt::format("> 0 and at most a tenth of the box's shorter side, {} m", widest));
    checks.number(true, "body_force: speed", force.speed, "finite (m/s)");
    for (const double place : force.place)
        checks.number(std::abs(place) <= furthest_rod * problem.box.shorter(), "body_force: position", place,
                      fmt::format("within {} box lengths of 0", furthest_rod));
    checks.require(force.place.empty() || force.place.size() == 2,
                   fmt::format("body_force: position of {} numbers: must have 2", force.place.size()));
}

void check_given(const GranularProblem& problem, Checks& checks) {
    checks.require((problem.start == Start::given) == problem.given.has_value(),
                   "start: given beads and no other start go together");
    if (!problem.given)
        return;
    const GivenBeads& given = *problem.given;
    const auto column = [&](const char* name, const auto& values, bool needed) {
        checks.require(
            values.size() == problem.beads || (!needed && values.empty()),
            fmt::format("given beads: {} values of {}: must be {}", values.size(), name, problem.beads));
    };
    column("x", given.x, true);
    column("y", given.y, true);
    column("z", given.z, false);
    column("vx", given.vx, false);
    column("vy", given.vy, false);
    column("vz", given.vz, false);
    column("radius", given.radius, false);
    column("kind", given.kind, !given.radius.empty() && problem.bead_kinds.size() > 1);
    checks.finish();
    for (std::size_t i = 0; i < problem.beads; ++i) {
        const double x = given.x[i], y = given.y[i];
        const bool outside = problem.container ? nearest_wall(*problem.container, {x, y}, 0.0).depth > 0.0
                                               : std::abs(x - 0.5 * problem.box.x) > 1.5 * problem.box.x ||
                                                     std::abs(y - 0.5 * problem.box.y) > 1.5 * problem.box.y;
        checks.require(!outside,
                       fmt::format("start_file: bead {} (from 0, by rows) is at ({:g}, {:g}) m, outside the "
                                   "{}: columns are in m",
                                   i, x, y, problem.container ? "wall" : "box and its next images"));
        if (outside)
            return; // one is enough
    }
}

} // namespace

double Plates::amplitude(double gravity) const {
    const double rate = 2.0 * M_PI * frequency;
    return gamma == 0.0 ? 0.0 : gamma * gravity / (rate * rate);
}

double Plates::longest_step(double gravity, double bead_radius) const {
    constexpr double least = 50.0, plate_move = 0.0137, fall = 2e-4; // steps a period; bead radii a step
    const double fastest = gamma == 0.0 ? 0.0 : gamma * gravity / (2.0 * M_PI * frequency);
    const double for_plates = fastest / (plate_move * bead_radius * frequency),
                 for_fall = std::sqrt(gravity / (2.0 * fall * bead_radius)) / frequency;
    return 1.0 / (std::ceil(std::max({least, for_plates, for_fall})) * frequency);
}

double bead_area_fraction(const GranularProblem& problem) {
    if (problem.bead_spread > 0.0 && problem.bead_area > 0.0)
        return problem.bead_area / bed_area(problem);
    double fraction = 0.0;
    if (problem.given && !problem.given->radius.empty()) {
        for (const double radius : problem.given->radius)
            fraction += M_PI * radius * radius / bed_area(problem);
        return fraction;
    }
    const BeadMix mix = bead_mix(problem);
    const std::vector<std::size_t> counts = kind_counts(problem);
    for (std::size_t k = 0; k < counts.size(); ++k) {
        const double a = mix.kinds.empty() ? mix.radius : mix.kinds[k].radius,
                     count = static_cast<double>(counts[k]);
        fraction += problem.container ? count * M_PI * a * a / problem.container->area()
                                      : count * M_PI * (a / problem.box.x) * (a / problem.box.y);
    }
    return fraction;
}

double bead_area_fraction(const GranularProblem& problem, std::span<const double> radii) {
    if (bead_mix(problem).equal() || radii.empty())
        return bead_area_fraction(problem);
    double squares = 0.0;
    for (const double radius : radii)
        squares += radius * radius;
    return M_PI * squares / bed_area(problem);
}

double bed_area(const GranularProblem& problem) {
    return problem.container ? problem.container->area() : problem.box.area();
}

double bead_mass(const GranularProblem& problem, double radius) {
    return 4.0 / 3.0 * M_PI * radius * radius * radius * problem.bead_density;
}

double mean_bead_mass(const GranularProblem& problem) {
    if (problem.bead_kinds.empty())
        return bead_mass(problem);
    double mass = 0.0, shares = 0.0;
    for (const BeadKind& kind : problem.bead_kinds) {
        mass += kind.share * bead_mass(problem, kind.radius);
        shares += kind.share;
    }
    return mass / shares;
}

std::int64_t whole_steps(double time, double step, std::int64_t least) {
    return std::max(least, static_cast<std::int64_t>(std::llround(time / step)));
}

void validate(const GranularProblem& problem) {
    Checks checks;
    check_numbers(problem, checks);
    const auto clumps = check_rods(problem, checks);
    checks.finish(); // the rest compares numbers that make sense
    check_box(problem, checks);
    if (problem.container)
        check_container(problem, clumps, checks);
    check_body_force(problem, checks);
    const BeadMix mix = bead_mix(problem);
    const double gap = problem.plates.gap, bead = 2.0 * mix.largest();
    checks.require(problem.beads == 0 || gap > bead,
                   fmt::format("gap = {} m between the plates: must be larger than the {}bead diameter, {} m",
                               gap, mix.equal() ? "" : "largest ", bead));
    for (std::size_t k = 0; k < problem.rods.size(); ++k)
        checks.require(gap > problem.rods[k].shape.thick_diameter,
                       fmt::format("rod {}: gap = {} m between the plates must be larger than the thickest "
                                   "diameter of the rod, {} m",
                                   k, gap, problem.rods[k].shape.thick_diameter));
    check_given(problem, checks);
    checks.finish();
    const double beads = bead_area_fraction(problem);
    const char* room = problem.container ? "container" : "box";
    double rods = 0.0;
    for (const Clump& clump : clumps)
        rods += clump.projected_area() / bed_area(problem);
    checks.require(
        beads + rods <= closest_packing,
        fmt::format("{} beads cover {:.4f} of the {} and the rods {:.4f}, together {:.4f}: a layer of discs "
                    "covers at most {:.4f}; use fewer beads (at most about {}) or a larger {}",
                    problem.beads, beads, room, rods, beads + rods, closest_packing,
                    std::max(0L, static_cast<long>((closest_packing - rods) * bed_area(problem) /
                                                   (M_PI * std::pow(mix.root_mean_square(), 2)))),
                    room));
    std::vector<std::vector<Disc>> rows;
    for (std::size_t k = 0; k < clumps.size(); ++k)
        rows.push_back(rod_discs(problem.rods[k], clumps[k]));
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t j = i + 1; j < rows.size(); ++j) {
            const double depth = overlap(rows[i], rows[j], problem.box);
            checks.require(depth <= 0.0,
                           fmt::format("rods {} and {} overlap by {:.3g} m (seen in the periodic box): move "
                                       "or turn one of them",
                                       i, j, depth));
        }
    checks.finish();
}

} // namespace rodwake::granular
