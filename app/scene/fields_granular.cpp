// Field lists of the granular bed: [granular] with its plates, contacts and output. SI (fields(Granular) says
// so).

#include "fields.hpp"

#include <fmt/format.h>

namespace rodwake::scene {

namespace {

using enum Dimension;

/// Area fraction of the densest layer of discs, pi/(2 sqrt 3), to the digits that make sense.
constexpr double densest = 0.9069;

void bead_fields(Visitor& v, Granular& bed) {
    v(key("phi_b")
          .symbol("\\phi_b")
          .above(0.0, densest)
          .because("a layer of equal discs cannot be denser than pi/(2 sqrt 3)")
          .doc("area fraction that the number of beads is made from, rounded; rods count towards it unless "
               "count_rod_area = false")
          .example("0.8"),
      bed.phi_b);
    v(key("beads").symbol("N").within(0, 1e7).doc("number of beads; 0 needs a rod").example("1549"),
      bed.beads);
    v(key("count_rod_area")
          .written_if(bed.phi_b.has_value())
          .doc("with phi_b; true: the beads that the rods displace are taken out, sum pi a^2 = phi_b L_x L_y "
               "- "
               "shadows "
               "of the rods, so that the bed around them is as dense as one of phi_b without rods; false: "
               "they "
               "stay and the bed is squeezed")
          .example("false"),
      bed.count_rod_area);
    v(key("bead_spread")
          .within(0.0, 0.2)
          .doc("standard deviation of the radii of beads of one kind, over their mean; normal, cut at two "
               "deviations; with phi_b all radii are then scaled by one factor near 1, so that the beads "
               "cover "
               "phi_b exactly")
          .example("0.02"),
      bed.bead_spread);
    v(key("bead_density").unit(density).above(0.0, 1e6).doc("mass density of the beads").example("2700.0"),
      bed.bead_density);
    v(key("gravity")
          .symbol("g")
          .unit(acceleration)
          .within(0.0, 1e4)
          .doc("towards the floor; 0: none, between plates that stand still (plates.gamma = 0)")
          .example("9.81"),
      bed.gravity);
    v(key("box")
          .symbol("L")
          .absent("needed without [granular.container]")
          .written_if(bed.box.x > 0.0)
          .unit(length)
          .above(0.0, 1e3)
          .doc("the periodic box: its side L, or a list of two, or \"fit\" with or without a length: the "
               "rectangle of about that size (78 bead radii by default) that a lattice without strain fills "
               "at phi_b, or has the same area with beads. Rows are along x or y by orientation. check "
               "prints it")
          .example("\"78 a\""),
      bed.box);
}

void start_fields(Visitor& v, Granular& bed) {
    v(key("start")
          .doc("lattice: beads on a triangular lattice; random: dropped at random; restart: the state in "
               "restart_from; file: the beads in start_file")
          .example("\"random\""),
      choice(bed.start, {{"lattice", GranularStart::lattice},
                         {"random", GranularStart::random},
                         {"restart", GranularStart::restart},
                         {"file", GranularStart::file}}));
    v(key("restart_from")
          .absent("only with start = \"restart\"")
          .doc("checkpoint file, seen from where the program runs; needed with start = \"restart\"")
          .example("\"results/bed/final.rwc\""),
      bed.restart_from);
    v(key("start_file")
          .absent("only with start = \"file\"")
          .doc("CSV of the beads, seen from the scene's folder, or from where the program runs: columns x, "
               "y, and "
               "of z (from the mean height of the floor), vx, vy, vz, radius (m, m/s) and kind (number in "
               "bead_kinds, from 0) those that are there; without z beads lie near mid gap and are moved "
               "apart "
               "where they overlap; what else is missing is drawn as for a random start. Or the "
               "trajectory.h5md of a bed in the same box, of which start_frame is taken: its beads without "
               "their spins, and between plates that shake without their heights")
          .example("\"beads.csv\""),
      bed.start_file);
    v(key("start_frame")
          .within(0, 1e6)
          .absent("the last one")
          .doc("frame of start_file, if that is a film, counted from 0")
          .example("20"),
      bed.start_frame);
    v(key("orientation")
          .unit(angle)
          .doc("wanted angle of the close-packed rows from +x; the lattice that closes in the box and is "
               "nearest is "
               "taken")
          .example("\"30 deg\""),
      bed.orientation);
    v(key("start_speed")
          .unit(speed)
          .within(0.0, 10.0)
          .doc("rms of each velocity component of the beads at the start")
          .example("\"20 mm/s\""),
      bed.start_speed);
}

void time_fields(Visitor& v, Granular& bed) {
    v(key("time_step")
          .symbol("\\Delta t")
          .unit(time)
          .above(0.0, 1e-3)
          .because("above 1e-3 s overlaps are far beyond overlap_limit")
          .absent("1/(n f), n >= 50 the least integer for which the plates move by at most 0.0137 and a body "
                  "falls by at most 2e-4 radii of the smallest beads in a step: 1e-4 s at gamma = 7, 200 Hz, "
                  "a = 0.4 mm")
          .doc("step of the integration")
          .example("\"2e-5 s\""),
      bed.time_step);
    v(key("equilibrate")
          .unit(time)
          .within(0.0, 1e7)
          .absent("lattice: 0.5 s; restart, file: 0; random: the time to order, 1 s up to phi_b = 0.60, then "
                  "linear "
                  "through 2 s (0.70), 8 s (0.72), 10 s (0.76), 24 s from 0.80 on")
          .doc("before t = 0, with the rods held where they are; round(equilibrate/time_step) steps")
          .example("\"0.5 s\""),
      bed.equilibrate);
    v(key("duration")
          .required()
          .unit(time)
          .above(0.0, 1e7)
          .doc("from t = 0 on; round(duration/time_step) steps, at least 1")
          .example("\"10 s\""),
      bed.duration);
    v(key("stop_at_travel")
          .unit(length)
          .above(0.0, 1e3)
          .absent("the run continues to its end")
          .doc("the run ends when the rods have come this far along their first headings, on average; "
               "needs rods")
          .example("\"39 a\""),
      bed.stop_at_travel);
    v(key("seed").within(0, largest_seed).doc("of everything random; --seed replaces it").example("7"),
      bed.seed);
    v(key("runs")
          .within(1, 1e6)
          .doc("number of runs that differ in their random start only; with [scan] of each point")
          .example("30"),
      bed.runs);
    v(key("overlap_limit")
          .above(0.0, 1.0)
          .doc("the run stops with an error if an overlap exceeds this fraction of the smaller radius (of a "
               "pair before t = 0: 0.5)")
          .example("0.1"),
      bed.overlap_limit);
    v(key("order_cutoff")
          .unit(length)
          .above(0.0, 1e3)
          .absent(
              "1.4 d with d = 2a sqrt(0.9069/phi), phi of the beads alone, near the first minimum of g(r)")
          .doc("beads nearer than this are neighbours in the order parameter psi6")
          .example("\"2.9 a\""),
      bed.order_cutoff);
}

void place_random_rods(Visitor& v, Granular& bed, const std::vector<GranularRod>& listed) {
    if (!bed.rods_random)
        return;
    const RandomBedRods& random = *bed.rods_random;
    if (!listed.empty())
        v.complain("rods", "[[granular.rods]] and [granular.rods_random] are given: leave one out");
    if (bed.box.fit)
        v.complain(
            "box",
            "box = \"fit\" depends on the rods, and [granular.rods_random] on the box: give its two sides");
    bed.rods = random_bed_rods(bed);
    const bool has_sides = !bed.box.fit && (bed.container || bed.box.x > 0.0);
    if (const auto placed = static_cast<long>(bed.rods.size()); has_sides && placed < random.count)
        v.complain(
            "rods_random",
            fmt::format("no room for {} rods of 4.5 mm with min_separation = {:g} m between them: after {} "
                        "no further one was found; lower count or min_separation, or take a larger bed",
                        random.count, random.min_separation, placed));
}

constexpr KeyAlternative count_forms[] = {{"phi_b"}, {"beads"}, {"start_file"}};

} // namespace

namespace {

void plate_fields(Visitor& v, Granular& bed) {
    granular::Plates& plates = bed.plates;
    const std::string absent = fmt::format(
        "{:g} mm; with beads of several sizes the larger of 1.2 mm and 2.7 radii of the largest bead",
        1e3 * default_gap(bed));
    v(key("gap")
          .symbol("w")
          .unit(length)
          .above(0.0, 1.0)
          .absent(absent)
          .doc("from floor to lid")
          .example("\"1.2 mm\""),
      static_cast<std::optional<double>&>(bed.gap));
    v(key("frequency")
          .symbol("f")
          .unit(rate)
          .above(0.0, 1e6)
          .doc("f, of floor and lid together")
          .example("\"200 Hz\""),
      plates.frequency);
    v(key("gamma")
          .symbol("\\Gamma")
          .within(0.0, 1e4)
          .doc("peak acceleration over gravity, A (2 pi f)^2/g (0: static plates)")
          .example("7.0"),
      plates.gamma);
}

} // namespace

void fields(Visitor& v, granular::Surface& surface) {
    v(key("friction").within(0.0, 1e3).doc("Coulomb coefficient").example("0.05"), surface.friction);
    v(key("restitution").within(0.0, 1.0).doc("energetic coefficient").example("0.3"), surface.restitution);
}

void fields(Visitor& v, SurfaceChange& change) {
    const char* absent = "as in particle_particle";
    v(key("friction").within(0.0, 1e3).absent(absent).doc("Coulomb coefficient").example("0.05"),
      change.friction);
    v(key("restitution").within(0.0, 1.0).absent(absent).doc("energetic coefficient").example("0.3"),
      change.restitution);
}

void fields(Visitor& v, Contacts& contacts) {
    v.table(key("particle_particle").doc("Beads and rods with each other."), contacts.particle_particle);
    v.table(key("rod_wall").doc("Rods with floor and lid."), contacts.rod_wall);
    v.table(key("bead_wall").doc("Beads with floor and lid."), contacts.bead_wall);
    v.table(key("bead_bead").doc("Beads with beads, where they differ from particle_particle."),
            contacts.bead_bead);
    v.table(key("bead_rod").doc("Beads with rods, where they differ from particle_particle."),
            contacts.bead_rod);
    v.table(key("rod_rod").doc("Rods with rods, where they differ from particle_particle."),
            contacts.rod_rod);
}

void fields(Visitor& v, BedContainer& container) {
    using enum granular::ContainerKind;
    const bool round = container.kind == circle;
    const char* absent = "beads: as in contacts.bead_wall, rods: as in contacts.rod_wall";
    v(key("kind")
          .doc("circle: a dish, the circle that touches the sides of [0, 2 radius] x [0, 2 radius]; "
               "rectangle: [0, sides.0] x [0, sides.1]")
          .example("\"rectangle\""),
      choice(container.kind, {{"circle", circle}, {"rectangle", rectangle}}));
    v(key("radius")
          .symbol("R")
          .written_if(round)
          .unit(length)
          .above(0.0, 1e3)
          .absent("needed with kind = \"circle\"")
          .doc("circle: radius of the wall; its middle is at x = y = radius")
          .example("\"40 a\""),
      container.radius);
    v(key("sides")
          .written_if(!round)
          .unit(length)
          .above(0.0, 1e3)
          .items(2, 2)
          .absent("needed with kind = \"rectangle\"")
          .doc("rectangle: along x and y, from wall to wall")
          .example("[\"80 a\", \"60 a\"]"),
      container.sides);
    v(key("friction").within(0.0, 1e3).absent(absent).doc("Coulomb coefficient of the wall").example("0.2"),
      container.friction);
    v(key("restitution")
          .within(0.0, 1.0)
          .absent(absent)
          .doc("energetic coefficient of the wall")
          .example("0.3"),
      container.restitution);
}

void fields(Visitor& v, granular::BodyForce& force) {
    using enum granular::BodyForceKind;
    v(key("kind")
          .doc(
              "uniform: the same everywhere; gaussian: b exp(-|r - R|^2/(2 width^2)) about R, which moves at "
              "`speed` along `direction`")
          .example("\"gaussian\""),
      choice(force.kind, {{"uniform", uniform}, {"gaussian", gaussian}}));
    v(key("acceleration")
          .symbol("b")
          .required()
          .unit(acceleration)
          .within(-1e4, 1e4)
          .doc("force on a bead over its mass, along `direction`; of a gaussian its peak")
          .example("0.5"),
      force.acceleration);
    v(key("direction").unit(angle).doc("of the force, counter-clockwise from +x").example("\"90 deg\""),
      force.direction);
    const bool moves = force.kind == gaussian;
    v(key("width")
          .written_if(moves)
          .unit(length)
          .within(0.0, 1e3)
          .doc("gaussian: standard deviation; at most a tenth of the box's shorter side")
          .example("\"4 a\""),
      force.width);
    v(key("speed")
          .written_if(moves)
          .unit(speed)
          .within(-10.0, 10.0)
          .doc("gaussian: of its centre along `direction`; negative: against the force")
          .example("\"1 mm/s\""),
      force.speed);
    v(key("position")
          .written_if(moves)
          .unit(length)
          .within(-1e3, 1e3)
          .items(2, 2)
          .absent("the middle of the box")
          .doc("gaussian: of its centre at t = 0, [x, y]")
          .example("[\"20 a\", \"39 a\"]"),
      force.place);
}

void fields(Visitor& v, GranularOutput& output) {
    v(key("frames")
          .unit(time)
          .above(0.0, 1e7)
          .absent("duration / 100")
          .doc("interval of the stored frames; at most 1000000 of them")
          .example("\"0.1 s\""),
      output.frames);
    v(key("table")
          .unit(time)
          .above(0.0, 1e7)
          .absent("0.01 s")
          .doc("interval of the rows of the table of rods, temperatures and order; at most 10000000 of them")
          .example("\"0.01 s\""),
      output.table);
    v(key("formats")
          .items(0, 3)
          .one_of({"h5md", "xyz", "xyz_if_short"})
          .because("others are made of a finished run, as in rodwake convert RUN -o film.gsd")
          .doc(
              "of the frames: H5MD, extended XYZ, extended XYZ if all runs together need less than 25 MB; [] "
              "stores no frames. rodwake convert makes others of a finished run")
          .example("[\"h5md\", \"xyz\"]"),
      output.formats);
    v(key("every_bead")
          .within(1, 1000000)
          .doc("1: all beads are in the frames; k: those numbered 0, k, 2k, ..., and the rods. For large "
               "beds, "
               "whose frames are then for looking at motion only: measure while the bed runs, as "
               "[measure] does")
          .example("10"),
      output.every_bead);
    v(key("last_period")
          .doc("also keep about 50 frames of one period of the plates at the end, for the side view")
          .example("false"),
      output.last_period);
    v(key("checkpoint")
          .unit(time)
          .above(0.0, 1e7)
          .doc("interval of the checkpoints in wall-clock time")
          .example("\"60 s\""),
      output.checkpoint);
    v(key("archive")
          .unit(time)
          .above(0.0, 1e7)
          .absent("none are kept")
          .doc("interval of the states kept in archive.rwc, from which rodwake replay makes any frame again "
               "to "
               "the bit, and rodwake measure frames that were not stored; 72 bytes a bead and state")
          .example("\"10 s\""),
      output.archive);
}

void fields(Visitor& v, Granular& bed) {
    Units units = si_units(bed.bead_radius);
    units.bead_words = false;
    v.use_units(units);
    v(key("bead_radius")
          .symbol("a")
          .unit(length)
          .above(0.0, 1.0)
          .doc("the unit \"a\" of these tables, and the radius of all beads unless "
               "[[granular.bead_kinds]] "
               "gives others")
          .example("\"0.4 mm\""),
      bed.bead_radius);
    v.use_units(si_units(bed.bead_radius));
    bead_fields(v, bed);
    start_fields(v, bed);
    // The beads are given in one of these ways; what an override drops is not given.
    v.one_form(count_forms, [&bed](int form) {
        if (form != 0)
            bed.phi_b.reset();
        if (form != 1)
            bed.beads.reset();
        if (form != 2)
            bed.start_file.clear();
    });
    time_fields(v, bed);
    v.table(key("plates").doc("Floor z = A cos(2 pi f t), lid the same plus the gap. Absent: the defaults, "
                              "which are the paper's."),
            bed.plates, [&](granular::Plates&) { plate_fields(v, bed); });
    v.table(key("contacts")
                .doc("What happens when two things touch. Absent: the defaults, which are the paper's."),
            bed.contacts);
    v.table(
        key("container")
            .doc("A vertical wall around the bed, which beads and rods hit; phi_b is then the share of the "
                 "area within. Absent: the bed is periodic in x and y."),
        bed.container);
    v.table(key("body_force")
                .doc("A force on the beads in the plane, from t = 0 on, with a rod or without. "
                     "Absent: there is none."),
            bed.body_force);
    v.table(key("output").doc("What is stored. Absent: the defaults."), bed.output);
    v.list(
        key("bead_kinds")
            .items(0, granular::most_bead_kinds)
            .doc("One entry for each kind of beads in the mixture, at random positions (start = \"random\"). "
                 "Absent: all beads have bead_radius."),
        bed.bead_kinds);
    v.table(key("rods_random")
                .doc("Rods at random in the bed, instead of [[granular.rods]]. They depend on these keys, "
                     "the sides of "
                     "the bed and its container alone, and are the same in all runs."),
            bed.rods_random);
    std::vector<GranularRod> listed;
    v.list(key("rods").items(0, max_rods).doc("One entry for each rod in the bed."),
           bed.rods_random ? listed : bed.rods);
    v.derive([&] {
        bed.plates.gap = bed.gap.value_or(default_gap(bed));
        place_random_rods(v, bed, listed);
    });
}

} // namespace rodwake::scene
