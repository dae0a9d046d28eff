// Tracks of simulations and viewers: LAMMPS dumps, extended XYZ, GSD, H5MD. The same film in each, and what
// is damaged or odd is told with its place and what to do. Files of other programs: test_track_peers.py.

#include "film_files.hpp"
#include "hdf5_edit.hpp"

#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <map>

using namespace rodwake;
using namespace store_test;

namespace {

TrackRows read(const std::string& name, const std::string& content, const store::TrackColumns& columns = {}) {
    const Scratch scratch;
    return read_film(scratch.file(name, content), columns);
}

/// Where each particle was at each step.
using Seen = std::map<std::pair<std::int64_t, std::int64_t>, std::pair<double, double>>;
Seen seen(const TrackRows& rows) {
    Seen all;
    for (std::size_t i = 0; i < rows.size(); ++i)
        all[{rows.frame.empty() ? static_cast<std::int64_t>(std::lround(1e3 * rows.time[i])) : rows.frame[i],
             rows.id[i]}] = {rows.x[i], rows.y[i]};
    return all;
}

const Seen truth{{{0, 4}, {1.0, 2.0}},   {{0, 5}, {3.0, 2.5}},   {{100, 4}, {1.25, 2.0}},
                 {{100, 5}, {9.5, 2.5}}, {{200, 4}, {1.5, 2.0}}, {{200, 5}, {9.0, 2.5}}};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos)
        throw std::logic_error("no " + from);
    return text.replace(at, from.size(), to);
}

store::TrackColumns own_times() {
    store::TrackColumns columns;
    columns.own_times = true;
    return columns;
}

} // namespace

TEST_CASE("A dump of LAMMPS: order of atoms, scaled and unwrapped places, CRLF, types") {
    const TrackRows rows = read("film", dump_film);
    CHECK(seen(rows) == truth);
    CHECK((rows.box && rows.box->x == 10.0 && rows.box->y == 8.0));
    CHECK(seen(read("film", replaced(dump_film, "x y z", "xu yu zu"))) == truth);
    std::string windows;
    for (const char c : dump_film)
        windows += c == '\n' ? "\r\n" : std::string(1, c);
    CHECK(seen(read("film", windows)) == truth);
    const TrackRows scaled =
        read("film", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp ff\n"
                     "-2 2\n0 8\n0 1\nITEM: ATOMS id xs ys ix\n1 0.75 0.5 3\n");
    CHECK(scaled.x == std::vector<double>{1.0});
    CHECK(scaled.y == std::vector<double>{4.0});
    store::TrackColumns rods;
    rods.rod_kinds = {"2"};
    CHECK(read("film", dump_film, rods).is_rod == std::vector<std::uint8_t>{0, 1, 1, 0, 0, 1});
    CHECK(read("film", dump_film).is_rod.empty());
    CHECK_FALSE(read("film", replaced(dump_film, "pp pp ff", "ff pp ff")).box);
    CHECK(has(read("film", replaced(dump_film, "0 10\n", "0 11\n")).no_box, "its box changes"));
    CHECK(has(read("film", replaced(dump_film, "BOUNDS pp pp ff\n0 10\n0 8\n",
                                    "BOUNDS xy xz yz pp pp ff\n0 10 1\n0 8 0\n"))
                  .no_box,
              "its box is not upright"));
    const TrackRows timed = read("film", dump_of(true), own_times());
    CHECK(timed.frame.empty());
    CHECK(seen(timed) == truth);
}

TEST_CASE("Extended XYZ: columns, lattice, steps and times; without ids lines tell who is who") {
    const TrackRows rows = read("film.xyz", xyz_film);
    CHECK(seen(rows) == truth);
    CHECK((rows.box && rows.box->x == 10.0 && rows.box->y == 8.0));
    CHECK(rows.is_rod == std::vector<std::uint8_t>{0, 1, 1, 0, 0, 1});
    CHECK(seen(read("film.xyz", xyz_film, own_times())) == truth);
    const std::string plain = "2\nfrom a camera\nC 1 2 0\nC 3 4 0\n\n2\n\nC 1.5 2 0\nC 3 4.5 0\n";
    const TrackRows lines = read("film.xyz", plain);
    CHECK(lines.id == std::vector<std::int64_t>{0, 1, 0, 1});
    CHECK(lines.frame == std::vector<std::int64_t>{0, 0, 1, 1});
    CHECK_FALSE(lines.box);
    CHECK(read("film.xyz", plain + "1\n\nC 9 9 0\n").id == std::vector<std::int64_t>(5, no_track));
    CHECK_FALSE(read("film.xyz", replaced(xyz_film, "T T F", "F F F")).no_box.empty()); // of the others it is
    store::TrackColumns named;
    named.time = "t";
    CHECK(read("film.xyz", "1\nt=0.5\nC 1 2 0\n", named).time == std::vector<double>{0.5});
}

TEST_CASE("GSD: places in the frame or as in the first, types, headings") {
    const Scratch scratch;
    write_gsd_film(scratch / "film.gsd");
    const TrackRows rows = read_film(scratch / "film.gsd");
    const SampleFrames samples;
    REQUIRE(rows.size() == 4 * 15);
    CHECK(rows.frame[15] == 500);
    CHECK(rows.id[16] == 1);
    REQUIRE(rows.box);
    CHECK(rows.box->x == Approx(samples.layout.box[0]).epsilon(1e-7)); // single precision: 6e-8
    const store::WrappedVectors at = store::wrap(samples.frame(2).position, samples.layout);
    for (std::size_t i = 0; i < 15; ++i) {
        CHECK(rows.x[30 + i] == Approx(at.place[3 * i] - 0.0156).margin(4e-9));
        CHECK(rows.is_rod[30 + i] == (i >= 9));
    }
    const TrackRows timed = read_film(scratch / "film.gsd", own_times());
    CHECK(timed.time[59] == samples.frame(3).time);
}

TEST_CASE("H5MD: beads and rods of a bed, a fixed step, no box, edges as a vector") {
    const Scratch scratch;
    write_h5md_film(scratch / "film.h5md");
    const TrackRows rows = read_film(scratch / "film.h5md");
    const SampleFrames samples;
    REQUIRE(rows.size() == 4 * 11); // 9 beads and 2 rods: their spheres are not counted
    CHECK(rows.id[9] == -2);
    CHECK(std::ranges::count(rows.is_rod, 1) == 8);
    CHECK(rows.frame[11] == 500);
    CHECK((rows.box && rows.box->x == samples.layout.box[0]));
    const auto& q = samples.frame(1).rod_orientation;
    CHECK(std::cos(rows.heading[11 + 10]) ==
          Approx((1.0 - 2.0 * (q[6] * q[6] + q[7] * q[7])) /
                 std::hypot(1.0 - 2.0 * (q[6] * q[6] + q[7] * q[7]), 2.0 * (q[4] * q[7] + q[5] * q[6]))));
    CHECK(read_film(scratch / "film.h5md", own_times()).time[11] == 0.01);
    {
        const Hdf5Edit file(scratch / "film.h5md");
        const std::string group = "particles/trajectory/";
        for (const char* name : {"position/step", "position/time"})
            file.replace(group + name, H5T_STD_I32LE, {});
        file.replace(group + "box/edges", H5T_IEEE_F32LE, {3});
    }
    const TrackRows other = read_film(scratch / "film.h5md", own_times());
    CHECK(other.time[33] == 3.0);
    CHECK((other.box && other.box->x == 1.0));
}

namespace {

struct Odd {
    std::string name, content, said; ///< said: empty if it is read
    store::TrackColumns columns = {};
};

std::vector<Odd> odd_texts() {
    store::TrackColumns named, t;
    named.x = "px";
    t.time = "t";
    const std::string d = dump_film, x = xyz_film, one = "1\nProperties=pos:R:2\n";
    return {
        {"film", "\xEF\xBB\xBF" + d, ""},
        {"film", d + "\n\n", ""},
        {"film", replaced(d, "BOUNDS pp pp ff", "BOUNDS"), ""},
        {"film", replaced(d, "5 2 3 2.5 0", "5 2 nan 2.5 0"), ""},
        {"film", "ITEM: UNITS\nlj\n" + d, ""},
        {"film", replaced(d, "TIMESTEP\n0", "TIMESTEP\n-5"), "film:2: \"-5\": expected a whole number"},
        {"film", replaced(d, "TIMESTEP\n0", "TIMESTEP\n1e99"), "film:2: \"1e99\": expected a whole number"},
        {"film", replaced(d, "ATOMS\n2", "ATOMS\n3"),
         "film:12: step 0 has 2 of its 3 atoms: is the dump cut short?"},
        {"film", replaced(d, "ATOMS\n2", "ATOMS\n99999999999"), "is the dump cut short? Remove this frame"},
        {"film", replaced(d, "ATOMS\n2", "ATOMS\n1"),
         "film:11: \"5 2 3 2.5 0\": expected a line that begins with ITEM:"},
        {"film", d.substr(0, d.size() - 8), "film:33: has 2 words, and column \"y\" would be number 4"},
        {"film", d.substr(0, 150), "film:14: \"ITE\": expected a line that begins"},
        {"film", replaced(d, "id type x y z", "id type a b c"),
         "film:9: no columns x and y, xu and yu, or xs and ys; the dump has id, type, a, b, c; name it in "
         "tracks.columns = { x = \"...\" }"},
        {"film", d, "film:9: no column \"px\"; the dump has id, type, x, y, z", named},
        {"film", d, "film: has no columns of times: leave tracks.time_column out", t},
        {"film", d, "film:9: the frame has no time: set tracks.frames_per_second", own_times()},
        {"film", replaced(d, "5 2 3 2.5", "5 2 3 2,5"), "film:11: y = \"2,5\": expected a number"},
        {"film", replaced(d, "5 2 3", "5.5 2 3"), "film:11: id = \"5.5\": expected a whole number"},
        {"film", replaced(d, "0 10\n", "0\n"), "film:6: \"\": expected a number"},
        {"film", replaced(d, "0 10\n", "10 0\n"),
         "film:9: the sides of the box, -10 and 8, are not positive"},
        {"film", replaced(d, "x y z", "xs ys zs"), ""},
        {"film", replaced(replaced(d, "x y z", "xs ys zs"), "BOUNDS pp", "BOUNDS xy xz yz pp"), ""},
        {"film", "ITEM: ENTRIES c\n", "film:1: ITEM: ENTRIES: expected a dump of atoms"},
        {"film", "ITEM: ATOMS id x y\n1 2 3\n", "film:1: ITEM: ATOMS without ITEM: TIMESTEP before it"},
        {"film.dump", "", "film.dump: has no particle with a place in its 0 frames"},
        {"film.xyz", "", "film.xyz: has no particle with a place in its 0 frames"},
        {"film.xyz", "two\n", "film.xyz:1: \"two\": expected the number of particles of the next frame"},
        {"film.xyz", "2\n", "film.xyz:1: a frame without its second line: is the file cut short?"},
        {"film.xyz", x.substr(0, x.size() - 15), "film.xyz:12: has "},
        {"film.xyz", replaced(x, "2\n", "3\n"), "film.xyz:5: has 1 words, expected the 6 of Properties="},
        {"film.xyz", replaced(x, "2\n", "1\n"),
         "film.xyz:4: \"B 3 2.5 0 5 rod\": expected the number of particles"},
        {"film.xyz", replaced(x, "pos:R:3", "place:R:3"),
         "film.xyz:2: no column \"pos\"; the frame has species, place"},
        {"film.xyz", replaced(x, "pos:R:3", "pos:R:x"), "film.xyz:2: Properties=species:S:1:pos:R:x"},
        {"film.xyz", replaced(x, "pos:R:3", "pos:R:1:z:R:2"),
         "film.xyz:2: Properties: pos has one component"},
        {"film.xyz", replaced(x, "Step=100", "Step=soon"), "film.xyz:6: Step=soon: expected a whole number"},
        {"film.xyz", replaced(x, "Step=100", ""), "film.xyz:6: frame 2 has no Step, unlike those before"},
        {"film.xyz", replaced(x, "Time=0.1", ""),
         "film.xyz:6: the frame has no time: set tracks.frames_per_second", own_times()},
        {"film.xyz", replaced(x, "Time=0.1", "Time=inf"), "film.xyz:6: the time inf is no time", own_times()},
        {"film.xyz", x,
         "film.xyz:2: no t= (tracks.time_column) in the second line of the frame; it has Lattice", t},
        {"film.xyz", replaced(x, "10 0 0 0 8", "10 0 0 0"),
         "film.xyz:2: Lattice=\"10 0 0 0 0 0 0 1\": expected nine"},
        {"film.xyz", replaced(x, "10 0 0 0 8", "10 0 0 0 0"),
         "film.xyz:2: the sides of the box, 10 and 0, are not"},
        {"film.xyz", replaced(x, "B 3 2.5", "B 3 x"), "film.xyz:4: y = \"x\": expected a number"},
        {"film.xyz", replaced(x, "0 5 rod", "0 - rod"), "film.xyz:4: id = \"-\": expected a whole number"},
        {"film.xyz", replaced(x, "B 3 2.5", "B inf 2.5"), ""},
        {"film.xyz", one + "1 2\n" + one + "nan 2\n", ""},
        {"film.xyz", "0\n\n" + one + "1 2\n", ""},
        {"film.xyz", "1\nProperties=\"\"\n1 2 3\n", "film.xyz:2: no column \"pos\""},
        {"film.csv", "frame,x,y\n0,1,2\n", "no rate of the film is given: set tracks.frames_per_second",
         own_times()},
        {"film.csv", std::string(20'000'000, 'a'),
         "film.csv:1: a line of more than 16 MB: is this a file of text?"},
        {"film.gsd", "no such thing",
         "film.gsd: its header of 1 x 256 bytes at byte 0 lies beyond its end, byte 13"},
        {"film.h5md", "no such thing",
         "film.h5md: not a readable HDF5 file; give an H5MD file with particles/"}};
}

} // namespace

TEST_CASE("Odd and damaged texts of tracks are read, or told of with line, column and remedy") {
    for (const Odd& odd : odd_texts()) {
        INFO(odd.name << ":\n" << odd.content.substr(0, 400));
        std::string told;
        try {
            const TrackRows rows = read(odd.name, odd.content, odd.columns);
            CHECK(rows.size() > 0);
        } catch (const InputError& error) {
            told = error.what();
        }
        CAPTURE(told, odd.said);
        CHECK((odd.said.empty() ? told.empty() : has(told, odd.said)));
    }
    CHECK_FALSE(has("a", "b")); // the check can fail
}

TEST_CASE("Damaged GSD is told of with frame, chunk and byte") {
    const Scratch scratch;
    write_gsd_film(scratch / "film.gsd");
    const std::string whole = content(scratch / "film.gsd");
    std::uint64_t index = 0;
    std::memcpy(&index, whole.data() + 8, 8);
    const auto put = [&](std::size_t at, std::uint64_t value, std::size_t bytes) {
        std::string text = whole;
        std::memcpy(text.data() + at, &value, bytes);
        return text;
    };
    const struct {
        std::string content, said;
    } cases[] = {{whole.substr(0, whole.size() - 100), "its names of "},
                 {whole.substr(0, index + 20), "its index of "},
                 {put(8, std::uint64_t{1} << 60, 8), "at byte 1152921504606846976 lies beyond its end"},
                 {put(16, std::uint64_t{1} << 60, 8), "its index of 1152921504606846976 x 32 bytes"},
                 {put(44, 3U << 16, 4), "is of GSD 3, and versions up to 2 are known"},
                 {put(112, 'x', 1), "is not of the schema hoomd"},
                 {put(index + 16, 0, 8), "film.gsd: has no frames"},
                 {put(index + 16, std::uint64_t{1} << 40, 8),
                  "a chunk of frame 0 of 6 x 4 bytes at byte 1099511627776 lies beyond its end"},
                 {put(index + 8, std::uint64_t{1} << 40, 8),
                  "frame 0: configuration/box has 1099511627776 rows, expected 6: the index is damaged"},
                 {put(index + 30, 77, 1), "frame 0: a chunk of unknown type 77: the index is damaged"},
                 {put(index + 24, 0, 4), "frame 0: configuration/box has 0 columns, expected 1"}};
    for (const auto& one : cases) {
        const std::string told =
            error_of<InputError>([&] { read_film(scratch.file("film.gsd", one.content)); });
        INFO(told);
        CHECK(has(told, "film.gsd: "));
        CHECK(has(told, one.said));
    }
}

TEST_CASE("Damaged H5MD is told of with its dataset") {
    const std::string group = "particles/trajectory/";
    const struct {
        std::function<void(const Hdf5Edit&)> damage;
        std::string said;
    } cases[] = {{[&](const Hdf5Edit& f) { f.remove("particles"); }, "no positions in a group of particles"},
                 {[&](const Hdf5Edit& f) { f.remove(group + "position/step"); },
                  "dataset " + group + "position/step is missing"},
                 {[&](const Hdf5Edit& f) {
                      f.replace(group + "position/value", H5T_IEEE_F64LE, {4, 15, 5});
                  },
                  "position is of shape [4, 15, 5]: expected two or three coordinates"},
                 {[&](const Hdf5Edit& f) {
                      f.replace(group + "position/value", H5T_IEEE_F64LE, {4, 3});
                  },
                  "position is of shape [4, 3]: expected frames, particles, 3"},
                 {[&](const Hdf5Edit& f) { f.resize(group + "position/step", 3); },
                  "position/step is of shape [3], and there are 4"},
                 {[&](const Hdf5Edit& f) { f.replace(group + "id", H5T_STD_I32LE, {14}); },
                  "id has 14 particles in 1 frames, position has 15 in 4"},
                 {[&](const Hdf5Edit& f) { f.replace(group + "id", H5T_IEEE_F32LE, {15}); },
                  "id holds values of another type"},
                 {[&](const Hdf5Edit& f) { f.remove(group + "box/edges"); },
                  "box/edges is missing, and the box is periodic"},
                 {[&](const Hdf5Edit& f) {
                      f.replace(group + "box/edges/value", H5T_IEEE_F64LE, {4, 7});
                  },
                  "box/edges is of shape [4, 7]: expected 3 or 3 x 3 numbers"},
                 {[&](const Hdf5Edit& f) { f.set(group + "box/edges/value", 0, -1.0); },
                  "position, frame 0: the sides of the box, -1 and 0.0312, are not positive"},
                 {[&](const Hdf5Edit& f) { f.text_attribute(group + "position", "unit", "mm"); }, ""},
                 {[&](const Hdf5Edit& f) { f.set(group + "position/value", 3, std::nan("")); }, ""}};
    const Scratch scratch;
    for (const auto& one : cases) {
        write_h5md_film(scratch / "film.h5md");
        { one.damage(Hdf5Edit(scratch / "film.h5md")); }
        std::string told;
        try {
            const TrackRows rows = read_film(scratch / "film.h5md");
            CHECK(rows.without_place + (rows.length_unit == "mm" ? 1 : 0) == 1);
        } catch (const InputError& error) {
            told = error.what();
        }
        CAPTURE(told, one.said);
        CHECK((one.said.empty() ? told.empty() : has(told, one.said)));
    }
    store::TrackColumns columns;
    columns.group = "walls";
    CHECK(has(error_of<InputError>([&] { read_film(scratch / "film.h5md", columns); }),
              "no positions of particles/walls (tracks.group); there are: trajectory, trajectory_rods"));
}
