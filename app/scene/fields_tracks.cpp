// Field list of [tracks], and what must hold between its values and beside them. SI (fields(Tracks) says so).

#include "check.hpp"
#include "fields.hpp"
#include "rodwake/granular/bead_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace rodwake::scene {

namespace {

using enum Dimension;

void file_fields(Visitor& v, Tracks& tracks) {
    v(key("file")
          .required()
          .doc("tracks: CSV of trackpy, pandas or TrackMate, TrackMate's XML, LAMMPS dump, extended XYZ, GSD "
               "or H5MD; seen from the scene's folder, or from where the program runs")
          .example("\"tracks.csv\""),
      tracks.file);
    v(key("rods_file")
          .absent("rods are in file, marked by a column kind")
          .doc("tracks of the rods, where they have a file of their own: every row is a rod; the same "
               "columns, "
               "frames and units")
          .example("\"rods.csv\""),
      tracks.rods_file);
    v(key("format").doc("of the file; automatic: by how it begins, else by its ending").example("\"csv\""),
      choice(tracks.format, {{"automatic", TrackFormat::automatic},
                             {"csv", TrackFormat::csv},
                             {"trackmate", TrackFormat::trackmate},
                             {"lammps", TrackFormat::lammps},
                             {"xyz", TrackFormat::xyz},
                             {"gsd", TrackFormat::gsd},
                             {"h5md", TrackFormat::h5md}}));
    v(key("frames_per_second")
          .unit(rate)
          .above(0.0, 1e6)
          .absent("times are in time_column, or the file's own")
          .doc("of the film, if rows have frame numbers; time steps a second, if the file counts those")
          .example("50.0"),
      tracks.frames_per_second);
    v(key("time_column")
          .absent("times follow from frames_per_second, or are the file's own")
          .doc("column of the times in s, instead of frame numbers; in extended XYZ a key of the second line")
          .example("\"t\""),
      tracks.time_column);
}

} // namespace

void fields(Visitor& v, TracksColumns& columns) {
    const auto name = [&](const char* of, const char* doc, const char* example, std::string& value) {
        v(key(of).absent("the usual one").doc(doc).example(example), value);
    };
    name("frame", "number of the frame, a whole number", "\"frame\"", columns.frame);
    name("id", "number of the particle; without such a column every row is a particle of its own",
         "\"particle\"", columns.id);
    name("x", "first coordinate", "\"x\"", columns.x);
    name("y", "second coordinate", "\"y\"", columns.y);
    name("heading", "direction of a rod's thin end, or of its axis (thin_end), from +x towards +y",
         "\"theta\"", columns.heading);
    v(key("ends")
          .items(4, 4)
          .absent("headings are in a column")
          .written_if(!columns.ends.empty())
          .doc("instead of heading: four columns, x and y of a rod's thin end and x and y of its thick end. "
               "Without columns x and y the middle is the rod's position")
          .example("[\"x1\", \"y1\", \"x2\", \"y2\"]"),
      columns.ends);
    v(key("radius")
          .absent("beads have bead_radius, or the radius of their kind")
          .doc("radius of a bead, in the unit of x and y")
          .example("\"radius\""),
      columns.radius);
    name("kind", "bead or rod (0 or 1), or see rod_kinds; without such a column all are beads", "\"kind\"",
         columns.kind);
}

void fields(Visitor& v, TracksKind& kind) {
    v(key("radius")
          .required()
          .unit(length)
          .above(0.0, 1.0)
          .doc("of the beads of this kind")
          .example("\"0.56 mm\""),
      kind.radius);
    v(key("names")
          .items(0, 100)
          .doc(
              "what the column of kinds calls them in CSV; []: a bead is of the kind whose radius is nearest "
              "to that in columns.radius, or in a file of another format to its own")
          .example("[\"large\"]"),
      kind.names);
}

void fields(Visitor& v, Tracks& tracks) {
    Units units = si_units(tracks.bead_radius);
    units.bead_words = false;
    v.use_units(units);
    v(key("bead_radius")
          .symbol("a")
          .unit(length)
          .above(0.0, 1.0)
          .doc("a; what \"a\" means here and in [measure]")
          .example("\"0.4 mm\""),
      tracks.bead_radius);
    v.use_units(si_units(tracks.bead_radius));
    file_fields(v, tracks);
    v(key("pixel")
          .required()
          .unit(length)
          .above(0.0, 1e3)
          .doc("what 1 of the file's x and y is worth")
          .example("\"12.4 um\""),
      tracks.pixel);
    v(key("angle")
          .unit(angle)
          .within(-1e3, 1e3)
          .doc("what 1 of the file's headings is worth; negative: they count from +x towards -y")
          .example("\"1 deg\""),
      tracks.angle);
    v(key("thin_end")
          .doc("given: headings and ends mark the thin end of a rod; ahead: they give its axis "
               "only, as for an ellipse, and the thin end is the one that goes ahead")
          .example("\"ahead\""),
      choice(tracks.thin_end, {{"given", ThinEnd::given}, {"ahead", ThinEnd::ahead}}));
    v(key("window")
          .doc(
              "what the camera sees: hull, the convex hull of all particles; periodic, the whole of a box; "
              "automatic, the file's periodic box if it has one, else the hull; or in the file's coordinates "
              "{ circle = [x, y, radius] } or { rectangle = [x0, y0, x1, y1] }")
          .example("\"hull\""),
      tracks.window);
    v(key("box")
          .unit(length)
          .above(0.0, 1e3)
          .absent("the file's own, or none")
          .doc("with window = \"periodic\" the periodic box, from 0 on: its side, or two sides")
          .example("\"78 a\""),
      tracks.box);
    v(key("localisation")
          .unit(length)
          .within(0.0, 1.0)
          .absent("nothing is taken off")
          .doc("standard error of a coordinate as the camera finds it, which is taken off the mean-square "
               "displacement and, if given, out of bond order; auto: as the shortest lags have it")
          .example("\"auto\""),
      tracks.localisation);
    v(key("longest_step")
          .unit(length)
          .above(0.0, 1e3)
          .doc(
              "a particle that steps farther from one frame to the next, or over a gap, is another one; "
              "auto: "
              "a camera's particles in an open window by more than 3 mean spacings, after a gap by more than "
              "1, particles of a simulation or a periodic window never; unlimited: never")
          .example("\"unlimited\""),
      tracks.longest_step);
    v(key("rod_kinds")
          .items(0, 100)
          .doc("types, species or kinds of the file that are rods, all others are beads; []: rod, motile, "
               "apolar, in CSV 1 too")
          .example("[\"2\"]"),
      tracks.rod_kinds);
    v.list(
        key("bead_kinds")
            .items(0, granular::most_bead_kinds)
            .doc("One entry for each size of beads: the area fraction counts their radii, and g(r) and the "
                 "stiffness are measured by kinds. Absent: all beads have one size."),
        tracks.bead_kinds);
    v(key("group")
          .absent("trajectory, all, or the only one")
          .doc("of H5MD files with several: the particles")
          .example("\"beads\""),
      tracks.group);
    v.table(key("columns").doc(
                "Names of the columns of the file. Absent: the usual ones, in CSV whatever the case "
                "of their letters: frame; particle or track_id; x, y or position_x, "
                "position_y; theta or heading; kind."),
            tracks.columns);
}

namespace {

/// Whether the file may have a box and times of its own: the reader knows.
bool may_have_own(const Tracks& t) {
    if (t.format != TrackFormat::automatic)
        return t.format != TrackFormat::csv && t.format != TrackFormat::trackmate;
    constexpr std::string_view never[] = {".csv", ".tsv", ".txt", ".xml"};
    return std::ranges::none_of(never, [&](std::string_view ending) { return t.file.ends_with(ending); });
}

} // namespace

void check_tracks(const Scene& scene, const Report& report) {
    if (!scene.tracks)
        return;
    const Tracks& t = *scene.tracks;
    if (t.frames_per_second && !t.time_column.empty())
        report("tracks.frames_per_second", "frames_per_second and time_column are given: leave one out");
    if (!t.frames_per_second && t.time_column.empty() && !may_have_own(t))
        report("tracks.frames_per_second", "give frames_per_second, or time_column where the file has times");
    if (t.format != TrackFormat::automatic && t.format != TrackFormat::csv && t.format != TrackFormat::xyz &&
        !t.time_column.empty())
        report(
            "tracks.time_column",
            "only CSV and extended XYZ have such columns: give frames_per_second, or leave it out where the "
            "file has times");
    if (t.box && t.window.kind != WindowKind::periodic)
        report("tracks.box", "box belongs to window = \"periodic\" only");
    if (!t.box && t.window.kind == WindowKind::periodic && !may_have_own(t))
        report("tracks.box", "window = \"periodic\" needs box, for example box = \"78 a\"");
    const std::vector<double>& sizes = t.window.sizes;
    if (t.window.kind == WindowKind::circle && !(sizes[2] > 0.0))
        report("tracks.window", "the radius of the circle must be above 0");
    if (t.angle == 0.0)
        report("tracks.angle", "angle is what 1 of the file's headings is worth: it must not be 0");
    if (!t.columns.ends.empty() && !t.columns.heading.empty())
        report("tracks.columns.ends",
               "ends and heading are given: a rod's direction follows from either; leave "
               "one out");
    for (std::size_t k = 1; k < t.bead_kinds.size(); ++k)
        if (t.bead_kinds[k].radius == t.bead_kinds[k - 1].radius)
            report("tracks.bead_kinds", "kinds differ in radius: two of one radius are one kind, which may "
                                        "have several names");
    if (t.window.kind == WindowKind::rectangle && !(sizes[0] < sizes[2] && sizes[1] < sizes[3]))
        report("tracks.window", "a rectangle is [x0, y0, x1, y1] with x0 below x1 and y0 below y1");
}

void check_measured_tracks(const Scene& scene, const Report& report) {
    if (!scene.measure || !scene.tracks)
        return;
    const Measure& m = *scene.measure;
    const std::pair<const char*, bool> of_beds_only[] = {{"force", m.force},
                                                         {"phonons", m.phonons},
                                                         {"mechanics", m.mechanics},
                                                         {"trajectory", !m.trajectory.empty()}};
    for (const auto& [key, is_asked] : of_beds_only)
        if (is_asked)
            report(std::string("measure.") + key,
                   fmt::format("{} needs a bed ([granular]), because it uses forces or velocities, and "
                               "[tracks] contain only positions and headings; leave it out",
                               key));
    if (!m.order && !m.microrheology && !m.displacement && !m.flow && !m.pairs && !m.heading_diffusion)
        report("measure", "[measure] lists nothing that can be measured on tracks: give order, "
                          "microrheology, displacement, flow, pairs or heading_diffusion");
    if (m.pairs && !m.contact_distance)
        report("measure.pairs", "pairs of [tracks] needs contact_distance, between the rods' centres: half a "
                                "rod's length, for example contact_distance = \"12 a\"");
    if (m.displacement == measure::DisplacementMethod::density &&
        scene.tracks->window.kind != WindowKind::periodic)
        report("measure.displacement", "density needs window = \"periodic\": give phase or lagrangian");
}

} // namespace rodwake::scene
