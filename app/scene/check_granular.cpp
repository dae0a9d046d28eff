#include "check_granular.hpp"

#include <fmt/format.h>
#include <optional>

namespace rodwake::scene {

namespace {

constexpr double max_steps = 1e12, max_frames = 1e6, max_rows = 1e7;

using Report = std::function<void(const std::string&, const std::string&)>;

void start(const Granular& bed, const Report& report) {
    if (bed.start == GranularStart::restart && bed.restart_from.empty())
        report("granular.start", "start = \"restart\" needs restart_from, the checkpoint to go on from");
    if (bed.start == GranularStart::restart && bed.box.fit)
        report("granular.box",
               "box = \"fit\" is made for a lattice and the rods in it, and the stored bed has a box: "
               "give its two sides and its beads, `box` (m) and `beads` in its summary.json");
    if (bed.start != GranularStart::restart && !bed.restart_from.empty())
        report("granular.restart_from", "restart_from belongs to start = \"restart\" only");
    if (bed.beads == 0 && bed.rods.empty())
        report("granular.beads", "beads = 0 and no [[granular.rods]]: nothing to simulate");
    if (!bed.count_rod_area && bed.beads)
        report("granular.count_rod_area",
               "count_rod_area belongs to phi_b: with beads the number of beads is given");
    if (bed.stop_at_travel && bed.rods.empty())
        report("granular.stop_at_travel", "stop_at_travel needs [[granular.rods]]: it is their travel");
}

void times(const Granular& bed, const Report& report) {
    const double step = time_step(bed), steps = (bed.equilibrate.value_or(0.0) + bed.duration) / step;
    if (steps > max_steps)
        report("granular.duration",
               fmt::format("{:g} s in steps of {:g} s are {:.3g} steps; at most {:g}",
                           bed.equilibrate.value_or(0.0) + bed.duration, step, steps, max_steps));
    const auto interval = [&](const char* name, std::optional<double> value, double most) {
        const std::string path = std::string("granular.output.") + name;
        if (value && *value < step)
            report(path, fmt::format("{} = {:g} s is shorter than time_step = {:g} s", name, *value, step));
        else if (value && bed.duration / *value > most)
            report(path, fmt::format("{} = {:g} s gives {:.3g} of them in {:g} s; at most {:g}", name, *value,
                                     bed.duration / *value, bed.duration, most));
    };
    interval("frames", bed.output.frames, max_frames);
    // Without the key the table has a row every 0.01 s.
    interval("table", bed.output.table.value_or(0.01), max_rows);
}

void body_force(const Granular& bed, const Report& report) {
    if (!bed.body_force)
        return;
    const granular::BodyForce& force = *bed.body_force;
    const auto belongs = [&](bool given, const char* name) {
        if (given)
            report(std::string("granular.body_force.") + name,
                   fmt::format("{} belongs to kind = \"gaussian\" only", name));
    };
    if (force.kind == granular::BodyForceKind::gaussian) {
        if (!(force.width > 0.0))
            report("granular.body_force.width", "kind = \"gaussian\" needs width, above 0");
        return;
    }
    belongs(force.width != 0.0, "width");
    belongs(force.speed != 0.0, "speed");
    belongs(!force.place.empty(), "position");
}

void rods(const Granular& bed, const Report& report) {
    const granular::RodShape unset;
    for (std::size_t i = 0; i < bed.rods.size(); ++i)
        if (const auto& shape = bed.rods[i].shape;
            shape.taper == granular::Taper::linear && shape.segments != unset.segments)
            report(fmt::format("granular.rods.{}.segments", i),
                   "segments belong to taper = \"stepwise\" only");
}

void radii(const Scene& scene, const Report& report) {
    if (scene.scales && scene.scales->bead_radius != scene.granular->bead_radius)
        report("granular.bead_radius",
               fmt::format(
                   "granular.bead_radius is {:g} m and scales.bead_radius {:g} m: \"a\" would be two lengths",
                   scene.granular->bead_radius, scene.scales->bead_radius));
}

} // namespace

double time_step(const Granular& bed) {
    return bed.time_step.value_or(bed.plates.longest_step(bed.gravity, bed.bead_radius));
}

void check_granular(const Scene& scene, const Report& report) {
    if (!scene.granular)
        return;
    start(*scene.granular, report);
    times(*scene.granular, report);
    rods(*scene.granular, report);
    body_force(*scene.granular, report);
    radii(scene, report);
}

} // namespace rodwake::scene
