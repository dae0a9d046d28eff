#include "run/describe_parts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace rodwake::app {

namespace {

using granular::GranularProblem;
using granular::Surface;

/// H5MD before compression: position and velocity in double, image in three 32-bit integers.
constexpr double h5md_bytes = 60.0;
/// While a run goes on: position and velocity in double.
constexpr double log_bytes = 48.0;
constexpr double most_period_frames = 75.0;
constexpr double large_output = 1e9; // B

/// "radius 0.4 mm", "radius 0.4 mm (600) and 0.56 mm (600)".
std::string sizes_text(const GranularProblem& problem) {
    const granular::BeadMix mix = granular::bead_mix(problem);
    const std::vector<std::size_t> counts = granular::kind_counts(problem);
    std::string text = mix.kinds.empty() ? fmt::format("radius {:g} mm", 1e3 * mix.radius) : "radius";
    for (std::size_t k = 0; k < mix.kinds.size(); ++k)
        text += fmt::format("{} {:g} mm ({})", k == 0 ? "" : " and", 1e3 * mix.kinds[k].radius, counts[k]);
    return mix.spread > 0.0 ? fmt::format("{}, spread {:g} of it,", text, mix.spread) : text;
}

std::string start_text(const scene::Granular& bed, const GranularProblem& problem) {
    switch (bed.start) {
    case scene::GranularStart::restart:
        return "start from the state in " + bed.restart_from;
    case scene::GranularStart::file:
        return fmt::format("start from the beads in {}{}", bed.start_file,
                           problem.given && problem.given->z.empty() ? ", heights near mid gap" : "");
    case scene::GranularStart::random:
        return fmt::format("random start, seed {}", problem.seed);
    case scene::GranularStart::lattice:
        break;
    }
    return fmt::format("start from a triangular lattice, rows at about {:g} rad, seed {}",
                       problem.orientation, problem.seed);
}

std::string rod_text(std::size_t index, const granular::RodSpec& rod, double bead_radius) {
    const granular::RodShape& shape = rod.shape;
    const granular::Clump clump = granular::make_clump(shape);
    std::string text = fmt::format(
        "rod {}: {}, {} spheres, {:g} mm long, {:.4g} mg, at ({:.4g} a, {:.4g} a) heading {:g} rad", index,
        shape.kind == granular::RodKind::motile ? "motile" : "apolar", shape.spheres, 1e3 * shape.length,
        1e6 * clump.mass, rod.position.x() / bead_radius, rod.position.y() / bead_radius, rod.heading);
    if (rod.imposed_speed)
        text += *rod.imposed_speed == 0.0 ? ", pinned"
                                          : fmt::format(", dragged at {:g} mm/s", 1e3 * *rod.imposed_speed);
    return text;
}

std::string contact_text(const char* pair, const Surface& surface) {
    return fmt::format("{} {:g}/{:g}", pair, surface.friction, surface.restitution);
}

std::string time_text(const scene::Granular& bed, const GranularProblem& problem) {
    return fmt::format(
        "{} steps of {:g} s from t = 0 ({:g} s) after {} of equilibration ({:g} s) with the rods held; "
        "{}{} run{}",
        problem.steps, problem.time_step, static_cast<double>(problem.steps) * problem.time_step,
        problem.equilibration_steps, static_cast<double>(problem.equilibration_steps) * problem.time_step,
        bed.stop_at_travel ? fmt::format("ends earlier if the rods have travelled {:.4g} a on average; ",
                                         *bed.stop_at_travel / bed.bead_radius)
                           : "",
        bed.runs, bed.runs == 1 ? "" : "s");
}

/// Of the stored frames of a run in all their formats.
double frames_bytes(const BedPlan& plan) {
    const scene::Granular& bed = *plan.of.scene.granular;
    return (plan.schedule.h5md ? h5md_bytes * stored_spheres(bed, plan.problem) * frame_count(bed) : 0.0) +
           (plan.schedule.xyz ? xyz_bytes(bed, plan.problem) : 0.0);
}

} // namespace

std::string size_text(double bytes) {
    static constexpr const char* units[] = {"B", "kB", "MB", "GB", "TB"};
    std::size_t unit = 0;
    for (; bytes >= 1000.0 && unit + 1 < std::size(units); ++unit)
        bytes /= 1000.0;
    return fmt::format("{:.3g} {}", bytes, units[unit]);
}

std::string output_advice(const BedPlan& plan) {
    const scene::Granular& bed = *plan.of.scene.granular;
    const double count = stored_spheres(bed, plan.problem),
                 stored = frames_bytes(plan) > 0.0 ? frame_count(bed) : 0.0,
                 of_period = bed.output.last_period ? static_cast<double>(period_frames) : 0.0,
                 bytes = frames_bytes(plan) + of_period * count * h5md_bytes;
    if (bytes <= large_output)
        return {};
    return fmt::format(
        "the frames of a run take up to {}, and {} more until it has ended; for less, granular.output.frames "
        "above {:g} s, every_bead above {}, formats = [] (no frames), last_period = false. Rows of the table "
        "and what [measure] "
        "finds on the way need none of them",
        size_text(bytes), size_text((stored + of_period) * count * log_bytes), frame_interval(bed),
        bed.output.every_bead);
}

std::string describe_output(const BedPlan& plan) {
    const scene::Granular& bed = *plan.of.scene.granular;
    const GranularProblem& problem = plan.problem;
    const scene::GranularOutput& output = bed.output;
    const double count = stored_spheres(bed, problem), frames = frame_count(bed);
    std::vector<std::string> formats;
    if (plan.schedule.h5md)
        formats.emplace_back("h5md");
    if (plan.schedule.xyz)
        formats.emplace_back("xyz");
    std::string text = formats.empty()
                           ? "no frames"
                           : fmt::format("{:.0f} frames of {:.0f} spheres ({}), at most {}", frames, count,
                                         fmt::join(formats, ", "), size_text(frames_bytes(plan)));
    if (output.last_period)
        text += fmt::format("; about {:.0f} frames of the last period, at most {}",
                            static_cast<double>(period_frames),
                            size_text(most_period_frames * count * h5md_bytes));
    return text +
           fmt::format("; a table of {:.0f} rows", std::floor(bed.duration / table_interval(bed)) + 1.0);
}

PlanLine body_force_line(const GranularProblem& problem) {
    if (!problem.body_force)
        return {false, "body force: no [granular.body_force]"};
    const granular::BodyForce& force = *problem.body_force;
    const double peak = force.acceleration * granular::mean_bead_mass(problem);
    const std::string along = fmt::format("{:.3g} N a bead ({:g} m/s^2) along {:g} deg", peak,
                                          force.acceleration, force.direction * 180.0 / std::numbers::pi);
    if (force.kind == granular::BodyForceKind::uniform)
        return {true, "body force on all beads: " + along};
    return {true, fmt::format(
                      "body force on the beads, a Gaussian of width {:.4g} a that moves at {:g} mm/s: {} at "
                      "its peak",
                      force.width / problem.bead_radius, 1e3 * force.speed, along)};
}

std::string box_text(const scene::Granular& bed, const GranularProblem& problem) {
    const double a = problem.bead_radius;
    if (problem.container) {
        const granular::Container& c = *problem.container;
        const std::string size =
            c.kind == granular::ContainerKind::circle
                ? fmt::format("dish of radius {:.6g} a = {:g} mm, its middle at ({:.6g} a, {:.6g} a)",
                              c.radius() / a, 1e3 * c.radius(), c.radius() / a, c.radius() / a)
                : fmt::format("rectangle of {:.6g} a x {:.6g} a = {:g} mm x {:g} mm", c.sides.x / a,
                              c.sides.y / a, 1e3 * c.sides.x, 1e3 * c.sides.y);
        return fmt::format("vertical wall around the bed, a {}; friction/restitution: {}, {}", size,
                           contact_text("beads", c.beads), contact_text("rods", c.rods));
    }
    const PeriodicBox& box = problem.box;
    if (box.square())
        return fmt::format("periodic box of {:.4g} a = {:g} mm", box.x / a, 1e3 * box.x);
    std::string text = fmt::format("periodic box of {:.6g} a x {:.6g} a = {:g} mm x {:g} mm", box.x / a,
                                   box.y / a, 1e3 * box.x, 1e3 * box.y);
    if (const auto lattice = bed_size(bed).lattice)
        text += fmt::format(", fitted to a lattice without strain: {} rows of {} sites along {}, row ratio "
                            "{:.6f} (sqrt(3)/2 = 0.866025)",
                            lattice->rows, lattice->in_row, lattice->rows_along_y ? "y" : "x",
                            lattice->row_ratio());
    return text;
}

void describe_granular(const Plan& plan, Lines& lines) {
    if (plan.scene.tracks)
        return describe_tracks(plan, lines);
    if (plan.beds.empty()) {
        lines.push_back({false, "granular bed: no [granular] table"});
        return;
    }
    const GranularProblem& problem = plan.beds.front().problem;
    const scene::Granular& bed = *plan.scene.granular;
    const bool with_rods = bed.phi_b && bed.count_rod_area && !bed.rods.empty();
    const double share = granular::bead_area_fraction(problem);
    lines.push_back(
        {problem.beads > 0,
         problem.beads > 0
             ? fmt::format("{} beads of {} and {:g} kg/m^3: phi_b = {:g}{}, of which the beads cover {:.4f}",
                           problem.beads, sizes_text(problem), problem.bead_density,
                           bed.phi_b.value_or(share), with_rods ? " with the rods' shadows" : "", share)
             : "beads: there are none"});
    lines.push_back({true, box_text(bed, problem)});
    const granular::Plates& plates = problem.plates;
    if (plates.gamma == 0.0)
        lines.push_back({false, fmt::format("vibration: gamma is 0, static plates with a gap of {:g} mm",
                                            1e3 * plates.gap)});
    else
        lines.push_back(
            {true, fmt::format("plates: gap {:g} mm, {:g} Hz, amplitude {:.4g} um (Gamma = {:g}), "
                               "{:.4g} steps a period",
                               1e3 * plates.gap, plates.frequency, 1e6 * plates.amplitude(problem.gravity),
                               plates.gamma, 1.0 / (plates.frequency * problem.time_step))});
    if (problem.gravity == 0.0)
        lines.push_back({false, "gravity: it is 0"});
    const granular::ContactTable& c = problem.contacts;
    lines.push_back(
        {true, fmt::format("contacts, friction/restitution: {}, {}, {}, {}, {}",
                           contact_text("bead-bead", c.bead_bead), contact_text("bead-rod", c.bead_rod),
                           contact_text("rod-rod", c.rod_rod), contact_text("bead-wall", c.bead_plate),
                           contact_text("rod-wall", c.rod_plate))});
    lines.push_back({true, start_text(bed, problem)});
    lines.push_back({true, time_text(bed, problem)});
    if (problem.rods.empty())
        lines.push_back({false, "rods in the bed: no [[granular.rods]]"});
    for (std::size_t i = 0; i < problem.rods.size(); ++i)
        lines.push_back({true, rod_text(i, problem.rods[i], problem.bead_radius)});
    lines.push_back(body_force_line(problem));
    if (const auto cutoff = order_cutoff(bed, granular::bead_area_fraction(problem)))
        lines.push_back(
            {true, fmt::format("order psi6 of beads nearer than {:.4g} a", *cutoff / problem.bead_radius)});
    else
        lines.push_back({false, "order psi6: no beads"});
    // Some keys of the start have no effect on a start of another kind.
    const scene::Granular unset;
    if (bed.start != scene::GranularStart::lattice && bed.orientation != unset.orientation && !bed.box.fit)
        lines.push_back({false, "granular.orientation: used with start = \"lattice\" only"});
    if (bed.start == scene::GranularStart::restart && bed.start_speed != unset.start_speed)
        lines.push_back({false, "granular.start_speed: not used with start = \"restart\""});
    if (plan.has(Stage::granular) || plan.has(Stage::measure)) // else a scan varies the bed
        describe_measures(plan.beds.front(), lines);
    // No scene has these: the bed leaves them out.
    lines.push_back(
        {false, "duration and elasticity of contacts: bodies are rigid, impacts instantaneous and in pairs"});
    lines.push_back({false, "rolling friction, cohesion, charge, air: no such force in the contact law"});
    if (!problem.container)
        lines.push_back(
            {false, "side walls: the box is periodic in x and y; [granular.container] has a wall"});
}

} // namespace rodwake::app
