#include "check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace rodwake::scene {

namespace {

constexpr double max_steps = 1e12, max_frames = 1e6, max_rows = 1e7;

void start(const Granular& bed, const Report& report) {
    if (bed.start == GranularStart::restart && bed.restart_from.empty())
        report("granular.start", "start = \"restart\" needs restart_from, the checkpoint to resume");
    if (bed.start == GranularStart::file && bed.start_file.empty())
        report("granular.start",
               "start = \"file\" needs start_file, the CSV of the beads, instead of phi_b and "
               "beads");
    if (bed.start != GranularStart::file && !bed.start_file.empty())
        report("granular.start_file", "start_file belongs to start = \"file\" only");
    if (bed.start != GranularStart::file && bed.start_frame)
        report("granular.start_frame", "start_frame belongs to start = \"file\" only");
    if (bed.start == GranularStart::file && bed.box.fit)
        report("granular.box",
               "box = \"fit\" is made for a lattice, and start_file has positions: give its two sides");
    if (bed.start == GranularStart::restart && bed.box.fit)
        report("granular.box",
               "box = \"fit\" is made for a lattice and the rods in it, and the stored bed has a box: "
               "give its two sides and its beads, `box` (m) and `beads` in its summary.json");
    if (const granular::BeadMix mix = bead_mix(bed); !mix.one_size()) {
        if (bed.start == GranularStart::lattice)
            report("granular.start",
                   "start = \"lattice\" puts equal beads on the sites of a triangular lattice, and "
                   "[[granular.bead_kinds]] have different radii: use start = \"random\"");
        if (bed.box.fit)
            report("granular.box",
                   "box = \"fit\" fits a lattice of equal beads, and [[granular.bead_kinds]] have "
                   "different radii: give its sides");
    }
    if (bed.start != GranularStart::restart && !bed.restart_from.empty())
        report("granular.restart_from", "restart_from belongs to start = \"restart\" only");
    if (bed.beads == 0 && bed.rods.empty())
        report("granular.beads", "beads = 0 and no [[granular.rods]]: nothing to simulate");
    if (!bed.count_rod_area && bed.beads)
        report("granular.count_rod_area", "count_rod_area has no effect with beads, which fixes the number "
                                          "of beads: give phi_b, or leave count_rod_area out");
    if (bed.stop_at_travel && bed.rods.empty())
        report("granular.stop_at_travel", "stop_at_travel needs [[granular.rods]]: it is their travel");
}

void room(const Granular& bed, const Report& report) {
    if (!bed.container) {
        if (!(bed.box.x > 0.0))
            report("granular.box", "granular needs the key box, for example box = \"78 a\", or a table "
                                   "[granular.container]");
        return;
    }
    if (bed.box.x > 0.0)
        report("granular.box", "box makes the bed periodic and [granular.container] encloses it in a wall: "
                               "leave one of them out");
    const bool round = bed.container->kind == granular::ContainerKind::circle;
    if (round && !bed.container->radius)
        report("granular.container.radius", "kind = \"circle\" needs radius, for example radius = \"40 a\"");
    if (!round && bed.container->sides.empty())
        report("granular.container.sides",
               "kind = \"rectangle\" needs sides, for example sides = [\"80 a\", \"60 a\"]");
    if (!round && bed.container->radius)
        report("granular.container.radius", "radius belongs to kind = \"circle\" only");
    if (round && !bed.container->sides.empty())
        report("granular.container.sides", "sides belong to kind = \"rectangle\" only");
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

} // namespace

double default_gap(const Granular& bed) {
    const double paper = granular::Plates{}.gap;
    const granular::BeadMix mix = bead_mix(bed);
    // Large beads come alive between 2.5 and 2.7 of their radii (findings.md, section 13).
    return mix.equal() ? paper : std::max(paper, 2.7 * mix.largest());
}

double time_step(const Granular& bed) {
    return bed.time_step.value_or(bed.plates.longest_step(bed.gravity, bead_mix(bed).smallest()));
}

void check_granular(const Scene& scene, const Report& report) {
    if (!scene.granular)
        return;
    const Granular& bed = *scene.granular;
    start(bed, report);
    room(bed, report);
    times(bed, report);
    const granular::RodShape unset;
    for (std::size_t i = 0; i < bed.rods.size(); ++i)
        if (const auto& shape = bed.rods[i].shape;
            shape.taper == granular::Taper::linear && shape.segments != unset.segments)
            report(fmt::format("granular.rods.{}.segments", i),
                   "segments belong to taper = \"stepwise\" only");
    if (bed.body_force) {
        const granular::BodyForce& force = *bed.body_force;
        const bool gaussian = force.kind == granular::BodyForceKind::gaussian;
        if (gaussian && !(force.width > 0.0))
            report("granular.body_force.width", "kind = \"gaussian\" needs width, above 0");
        const std::pair<const char*, bool> given[] = {
            {"width", force.width != 0.0}, {"speed", force.speed != 0.0}, {"position", !force.place.empty()}};
        for (const auto& [name, is_given] : given)
            if (is_given && !gaussian)
                report(std::string("granular.body_force.") + name,
                       fmt::format("{} belongs to kind = \"gaussian\" only", name));
    }
    if (scene.scales && scene.scales->bead_radius != bed.bead_radius)
        report("granular.bead_radius",
               fmt::format(
                   "granular.bead_radius is {:g} m and scales.bead_radius {:g} m: \"a\" would be two lengths",
                   bed.bead_radius, scene.scales->bead_radius));
}

namespace {

void rods(const Measure& m, const Granular& bed, const Report& report) {
    const auto count = static_cast<long>(bed.rods.size());
    const auto want_rod = [&](bool wanted, const char* key) {
        if (wanted && count == 0)
            report(std::string("measure.") + key,
                   fmt::format("{} needs [[granular.rods]]: it is seen from a rod", key));
    };
    want_rod(m.flow, "flow");
    want_rod(m.force, "force");
    const bool moving = bed.body_force && bed.body_force->kind == granular::BodyForceKind::gaussian;
    if (m.displacement && count == 0 && !moving)
        report("measure.displacement", "displacement needs [[granular.rods]], or a [granular.body_force] of "
                                       "kind \"gaussian\", as the origin of its frame");
    want_rod(m.heading_diffusion, "heading_diffusion");
    if (m.mechanics && bed.body_force && bed.body_force->kind != granular::BodyForceKind::uniform)
        report("measure.mechanics",
               "mechanics has to know all of the force on the bed: make [granular.body_force] kind = "
               "\"uniform\", or leave out it or mechanics");
    if (m.inertia_error && !m.inertia_factor)
        report("measure.inertia_error", "inertia_error is the error of inertia_factor, which is not set: "
                                        "give inertia_factor (1 or a little more), or leave both out");
    want_rod(m.from_travel.has_value(), "from_travel (or a distance in from)");
    if (m.pairs && count != 2)
        report("measure.pairs", fmt::format("pairs needs two [[granular.rods]]; there are {}", count));
    if (count > 0 && m.rod >= count)
        report("measure.rod",
               fmt::format("there is no rod {}: granular.rods has {} (numbered from 0)", m.rod, count));
}

void times(const Measure& m, const Granular& bed, const Report& report) {
    const double interval = m.interval.value_or(bed.output.frames.value_or(bed.duration / 100.0));
    if (m.interval && *m.interval < time_step(bed))
        report("measure.interval",
               fmt::format("interval = {:g} s is shorter than granular.time_step = {:g} s", *m.interval,
                           time_step(bed)));
    if (m.block < interval)
        report("measure.block",
               fmt::format("block = {:g} s is shorter than the interval of {:g} s", m.block, interval));
    if (m.from >= bed.duration && m.trajectory.empty())
        report("measure.from",
               fmt::format("from = {:g} s is not before the end of the run, {:g} s: nothing would "
                           "be measured",
                           m.from, bed.duration));
    if (m.order_interval) {
        const double ratio = *m.order_interval / interval;
        if (ratio < 0.999 || std::abs(ratio - std::round(ratio)) > 1e-6 * ratio)
            report("measure.order_interval",
                   fmt::format("order_interval = {:g} s is no whole multiple of the interval "
                               "of {:g} s",
                               *m.order_interval, interval));
    }
    // The number of frames of a trajectory from elsewhere is not known here.
    constexpr double least = 32.0; // of microrheology
    const double count = std::floor((bed.duration - m.from) / interval * (1.0 + 1e-9)) + 1.0;
    if (m.microrheology && m.trajectory.empty() && count >= 1.0 && count < least)
        report(
            "measure.microrheology",
            fmt::format(
                "microrheology needs at least {:g} frames, and there are {:g}: shorten measure.interval or "
                "granular.output.frames, or run longer",
                least, count));
    if (m.flow && m.flow_lag > m.block)
        report("measure.flow_lag",
               fmt::format("flow_lag = {:g} s is longer than block = {:g} s", m.flow_lag, m.block));
    if (m.bead_drag_error && !m.bead_drag)
        report("measure.bead_drag_error", "measure.bead_drag_error is set but measure.bead_drag is not: set "
                                          "measure.bead_drag, or remove the error");
    if (m.s_low && m.s_high && !(*m.s_low < *m.s_high))
        report("measure.s_high",
               fmt::format("s_high = {:g} must be above s_low = {:g}", *m.s_high, *m.s_low));
}

void currents(const Measure& m, const Granular& bed, const Report& report) {
    if (!m.phonons)
        return;
    const double interval = m.interval.value_or(bed.output.frames.value_or(bed.duration / 100.0));
    if (m.phonon_interval) {
        const double ratio = interval / *m.phonon_interval;
        if (ratio < 0.999 || std::abs(ratio - std::round(ratio)) > 1e-6 * ratio)
            report("measure.phonon_interval",
                   fmt::format("phonon_interval = {:g} s: the interval of {:g} s is no whole multiple of it",
                               *m.phonon_interval, interval));
        if (*m.phonon_interval < time_step(bed))
            report("measure.phonon_interval",
                   fmt::format("phonon_interval = {:g} s is shorter than granular.time_step = {:g} s",
                               *m.phonon_interval, time_step(bed)));
    }
    if (m.phonon_lag && 2.0 * *m.phonon_lag > m.block)
        report("measure.phonon_lag", fmt::format("phonon_lag = {:g} s is longer than half of block = {:g} s",
                                                 *m.phonon_lag, m.block));
    constexpr double usual = 5e-3, least = 6.0; // s; intervals in a lag that a fit can use
    const double fine = m.phonon_interval.value_or(std::min(usual, interval)),
                 lag = m.phonon_lag.value_or(std::min(1.0, 0.5 * m.block));
    if (lag < least * fine)
        report(
            "measure.phonon_lag",
            fmt::format("the longest lag of the currents, {:g} s, is below {:g} of their intervals of {:g} "
                        "s; choose a longer phonon_lag and block, or a shorter phonon_interval",
                        lag, least, fine));
    if (m.trajectory.empty() && bed.duration - m.from < 2.0 * m.block)
        report("measure.phonons",
               fmt::format("phonons need at least 2 blocks for their errors: {:g} s are measured and block = "
                           "{:g} s; shorten measure.block or run longer",
                           bed.duration - m.from, m.block));
}

/// What is defined for beads of one size on a lattice only.
void equal_beads_only(const Measure& m, const Report& report) {
    const struct {
        const char *key, *what, *why;
        bool wanted;
    } keys[] = {
        {"displacement", "displacement = \"phase\" or \"density\"",
         "they follow the Bragg peaks of a lattice, which beads of several sizes do not form; use "
         "displacement = \"lagrangian\"",
         m.displacement && m.displacement != measure::DisplacementMethod::lagrangian},
        {"phonons", "phonons", "they are waves of a lattice, which beads of several sizes do not form",
         m.phonons},
        {"mechanics", "mechanics", "it takes the mass of a bead, and here beads have several", m.mechanics},
        {"order_neighbours", "order_neighbours = \"cutoff\"",
         "they have no common first shell; use order_neighbours = \"delaunay\", or give order_cutoff",
         m.order && m.order_neighbours == measure::Neighbours::cutoff && !m.order_cutoff}};
    for (const auto& item : keys)
        if (item.wanted)
            report(std::string("measure.") + item.key,
                   fmt::format("{} with beads of several sizes ([[granular.bead_kinds]]): {}", item.what,
                               item.why));
}

} // namespace

void check_measure(const Scene& scene, const Report& report) {
    if (!scene.measure || !scene.granular)
        return;
    const Measure& m = *scene.measure;
    const Granular& bed = *scene.granular;
    rods(m, bed, report);
    times(m, bed, report);
    currents(m, bed, report);

    // Lags of the headings.
    const double measured = bed.duration - m.from, high = heading_lag_high(m, measured);
    if (m.heading_lag_high && 2.0 * high > m.block)
        report("measure.heading_lag_high",
               fmt::format("heading_lag_high = {:g} s is longer than half of block = {:g} s", high, m.block));
    if (m.heading_lag_low && *m.heading_lag_low >= high)
        report("measure.heading_lag_low",
               fmt::format("heading_lag_low = {:g} s must be below the longest lag of {:g} s{}",
                           *m.heading_lag_low, high, m.heading_lag_high ? "" : ", a quarter of block"));
    if (m.heading_diffusion && m.trajectory.empty() && measured < 2.0 * high)
        report("measure.heading_diffusion",
               fmt::format("lags up to {:g} s need twice as much, and {:g} s are measured: shorten "
                           "measure.heading_lag_high or run longer",
                           high, measured));

    // Nearest images and wave vectors are those of a box.
    const std::tuple<const char*, const char*, bool> periodic_only[] = {
        {"displacement", "displacement = \"density\"",
         m.displacement == measure::DisplacementMethod::density},
        {"mechanics", "mechanics", m.mechanics},
        {"phonons", "phonons", m.phonons}};
    for (const auto& [key, what, wanted] : periodic_only)
        if (bed.container && wanted)
            report(std::string("measure.") + key,
                   fmt::format("{} is measured in a periodic box, and this bed has a wall: leave it out, or "
                               "give granular.box instead of [granular.container]",
                               what));
    if (!bead_mix(bed).one_size())
        equal_beads_only(m, report);

    // Lengths are compared with the shorter side of the box, or of what the container fits into, m; endless
    // where that is not known.
    double side = bed.box.shorter();
    if (bed.container)
        side = !bed.container->sides.empty() ? std::ranges::min(bed.container->sides)
               : bed.container->radius       ? 2.0 * *bed.container->radius
                                             : HUGE_VAL;
    const std::tuple<const std::optional<double>&, const char*, double, const char*> lengths[] = {
        {m.spacing, "spacing", side / 4.0, "a quarter of the box"},
        {m.flow_spacing, "flow_spacing", side / 4.0, "a quarter of the box"},
        {m.order_cutoff, "order_cutoff", side / 4.0, "a quarter of the box"},
        {m.marked_within, "marked_within", side / 2.0, "half the box"},
        {m.profile_offset, "profile_offset", side / 2.0, "half the box"},
        {m.far_from, "far_from", 0.45 * side, "0.45 of the box: beyond it hardly a bead is left"}};
    for (const auto& [value, key, most, why] : lengths)
        if (value && *value > most)
            report(std::string("measure.") + key,
                   fmt::format("{} = {:g} m: at most {:g} m, {}", key, *value, most, why));
    if (m.order_cutoff && m.order_neighbours == measure::Neighbours::delaunay)
        report("measure.order_cutoff", "order_cutoff belongs to order_neighbours = \"cutoff\" only");
}

} // namespace rodwake::scene
