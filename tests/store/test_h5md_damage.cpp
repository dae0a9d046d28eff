// Trajectories that are none, are incomplete or cannot be: an error that names the file, never a crash.

#include "hdf5_edit.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "stored_frames.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <sys/resource.h>

using namespace rodwake;
using namespace store_test;

namespace {

const std::string group = "particles/trajectory/", rods = "particles/trajectory_rods/";
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

struct Damage {
    std::string expected; ///< part of the message
    std::function<void(const Hdf5Edit&)> work;
};

/// The message for a sample file with this damage.
std::string message_for(const Scratch& scratch, const Damage& damage) {
    write_h5md(scratch / "t.h5md", SampleFrames());
    { damage.work(Hdf5Edit(scratch / "t.h5md")); }
    return error_of<InputError>([&] { holds(scratch / "t.h5md", SampleFrames()); });
}

void check_refused(const std::vector<Damage>& damages) {
    const Scratch scratch;
    for (const Damage& damage : damages) {
        CAPTURE(damage.expected);
        const std::string text = message_for(scratch, damage);
        INFO(text);
        CHECK(has(text, (scratch / "t.h5md").string() + ": "));
        CHECK(has(text, damage.expected));
        CHECK(has(text, "; give a trajectory.h5md as rodwake dem writes it"));
    }
}

Damage value(const std::string& path, std::size_t index, double number, const std::string& expected) {
    return {expected, [=](const Hdf5Edit& file) { file.set(path, index, number); }};
}

Damage shape(const std::string& path, hid_t type, const std::vector<hsize_t>& extent,
             const std::string& expected) {
    return {path + expected, [=](const Hdf5Edit& file) { file.replace(path, type, extent); }};
}

} // namespace

TEST_CASE("What is no trajectory at all is refused") {
    const Scratch scratch;
    const auto opened = [&](const std::string& name) {
        return error_of<InputError>([&] { store::H5mdReader(scratch / name); });
    };
    scratch.file("text", "text");
    scratch.file("empty", "");
    fs::create_directory(scratch / "folder");
    CHECK(has(opened("none"), "none: no such file; give a trajectory.h5md"));
    CHECK(has(opened("text"), "text: not a readable HDF5 file"));
    CHECK(has(opened("empty"), "empty: not a readable HDF5 file"));
    CHECK(has(opened("folder"), "folder: not a file that can be read"));
    SampleFrames no_frames;
    no_frames.frames.clear();
    write_h5md(scratch / "bare", no_frames);
    CHECK(has(opened("bare"), "bare: the trajectory holds no frames"));
}

TEST_CASE("What is missing is named") {
    std::vector<Damage> damages;
    for (const std::string& path :
         {std::string("particles"), std::string("particles/trajectory"), std::string("parameters")})
        damages.push_back(
            {"group " + path + " is missing", [=](const Hdf5Edit& file) { file.remove(path); }});
    for (const char* name : {"position/step", "position/time", "position/value", "image/value",
                             "velocity/value", "box/edges/value", "species", "radius", "mass"})
        damages.push_back({"dataset " + group + name + " is missing",
                           [=](const Hdf5Edit& file) { file.remove(group + name); }});
    for (const char* name : {"position/value", "image/value", "orientation/value", "mass"})
        damages.push_back({"dataset " + rods + name + " is missing",
                           [=](const Hdf5Edit& file) { file.remove(rods + name); }});
    damages.push_back({"6 particles are not beads, but particles/trajectory_rods contains no rods",
                       [](const Hdf5Edit& file) { file.remove("particles/trajectory_rods"); }});
    damages.push_back({"attribute seed of rodwake is missing",
                       [](const Hdf5Edit& file) { file.remove_attribute("rodwake", "seed"); }});
    damages.push_back(
        {"attribute seed of rodwake is missing", [](const Hdf5Edit& file) { file.remove("rodwake"); }});
    damages.push_back({"attribute boundary of " + group + "box is missing",
                       [](const Hdf5Edit& file) { file.remove_attribute(group + "box", "boundary"); }});
    check_refused(damages);
}

TEST_CASE("Shapes and types that do not fit are refused") {
    const hid_t real = H5T_IEEE_F64LE, whole = H5T_STD_I32LE;
    check_refused(
        {shape(group + "position/value", real, {4, 15, 2}, " is of shape [4, 15, 2], expected [4, 15, 3]"),
         shape(group + "image/value", whole, {3, 15, 3}, " is of shape"),
         shape(group + "velocity/value", real, {4, 45}, " is of shape"),
         shape(group + "box/edges/value", real, {4, 3}, " is of shape"),
         shape(group + "velocity/value", H5T_IEEE_F32LE, {4, 15, 3}, " holds values of another type"),
         shape(group + "position/value", real, {}, " is of shape [], expected"),
         shape(group + "species", H5T_STD_I64LE, {15}, " holds values of another type"),
         shape(group + "position/step", whole, {4}, " holds values of another type"),
         shape(group + "radius", real, {15, 1}, " is not a single column"),
         shape(rods + "position/value", real, {4, 1, 3}, " is of shape"),
         shape(rods + "image/value", whole, {4, 3, 3}, " is of shape"),
         shape(rods + "orientation/value", real, {4, 2, 3}, " is of shape")});
    check_refused({{"4 steps at 3 times", [](const Hdf5Edit& f) { f.resize(group + "position/time", 3); }},
                   {"15 particles have 14 values of radius",
                    [](const Hdf5Edit& f) { f.replace(group + "radius", H5T_IEEE_F64LE, {14}); }},
                   {"cannot open dataset " + group + "mass", [](const Hdf5Edit& f) {
                        f.remove(group + "mass");
                        f.link(group + "box", group + "mass");
                    }}});
}

TEST_CASE("Moments, boxes and particles that cannot be are refused") {
    const std::string edges = group + "box/edges/value", later = " is not later than the one before";
    const double inf = std::numeric_limits<double>::infinity();
    check_refused({value(group + "position/step", 2, 500, "frame 2 (step 500, 0.02 s)" + later),
                   value(group + "position/step", 3, -1, "frame 3 (step -1, 0.03 s)" + later),
                   value(group + "position/time", 1, 0.0, "frame 1 (step 500, 0 s)" + later),
                   value(group + "position/time", 3, not_a_number, "the time of frame 3 is not finite"),
                   value(edges, 0, not_a_number, "the edges of the box are not three positive sides"),
                   value(edges, 4, -0.0312, "the edges of the box are not"),
                   value(edges, 8, inf, "the edges of the box are not"),
                   value(edges, 1, 1e-3, "the edges of the box are not"),
                   value(edges, 9 * 3, 0.03, "the box changes in frame 3"),
                   value(edges, 9 * 1 + 4, not_a_number, "the box changes in frame 1"),
                   value(group + "species", 0, 1, "the beads (species 0) are not the first of its 15"),
                   value(group + "species", 14, 0, "the beads (species 0) are not the first of its 15"),
                   value(group + "radius", 8, 3e-4,
                         "beads have different radii, and parameters/bead_radius, the unit of lengths, is"),
                   value(group + "radius", 1, not_a_number, "the radius of bead 1 is nan"),
                   value(group + "mass", 0, 0.0, "the mass of bead 0 is 0: not positive"),
                   value(group + "mass", 0, inf, "the mass of bead 0 is inf: not positive")});
    check_refused(
        {{"parameter phi_b is not finite",
          [](const Hdf5Edit& f) { f.attribute("parameters", "phi_b", H5T_NATIVE_DOUBLE, &not_a_number); }},
         {"the box is not periodic in x and y",
          [](const Hdf5Edit& f) {
              const hid_t text = H5Tcopy(H5T_C_S1); // of one character
              f.attribute(group + "box", "boundary", text, "ppp", 3);
          }},
         {"attribute boundary of " + group + "box is not a text",
          [](const Hdf5Edit& f) {
              f.attribute(group + "box", "boundary", H5T_NATIVE_DOUBLE, &not_a_number);
          }},
         {"attribute seed of rodwake is not one unsigned integer",
          [](const Hdf5Edit& f) { f.attribute("rodwake", "seed", H5T_NATIVE_DOUBLE, &not_a_number); }}});
}

TEST_CASE("A box has a wall in x and y, or in neither") {
    const Scratch scratch;
    SampleFrames walled;
    walled.layout.periodic = {false, false, false};
    write_h5md(scratch / "walled.h5md", walled);
    CHECK_FALSE(store::H5mdReader(scratch / "walled.h5md").info().periodic);
    write_h5md(scratch / "periodic.h5md", SampleFrames());
    CHECK(store::H5mdReader(scratch / "periodic.h5md").info().periodic);
    for (const std::array<bool, 3> periodic :
         {std::array{true, false, false}, std::array{false, true, false}}) {
        SampleFrames samples;
        samples.layout.periodic = periodic;
        write_h5md(scratch / "t.h5md", samples);
        CHECK(has(error_of<InputError>([&] { store::H5mdReader(scratch / "t.h5md"); }),
                  "the box is not periodic in x and y"));
    }
}

TEST_CASE("A frame that cannot be is refused, the others are read") {
    const Scratch scratch;
    const SampleFrames samples;
    const std::size_t frame = 45 * 2, rod = 6 * 2; // first element of frame 2
    const std::string out = "outside the box of 0.0312 x 0.0312 m";
    for (const Damage& damage :
         {value(group + "position/value", frame, 0.0312, "frame 2: bead 0 is at (0.0312, "),
          value(group + "position/value", frame + 4, -1e-300, out),
          value(group + "position/value", frame + 24, not_a_number, "bead 8 is at (nan, "),
          value(group + "position/value", frame + 2, not_a_number, "frame 2: positions that are not finite"),
          value(group + "velocity/value", frame + 7, HUGE_VAL, "frame 2: velocities that are not finite"),
          value(rods + "position/value", rod + 4, 0.04, "frame 2: rod 1 is at ("),
          value(rods + "position/value", rod, not_a_number, "frame 2: rod 0 is at (nan, "),
          value(rods + "orientation/value", 8 * 2 + 5, not_a_number,
                "frame 2: the orientation of rod 1 is 0 or not")}) {
        const std::string text = message_for(scratch, damage);
        INFO(text);
        CHECK(has(text, damage.expected));
        store::H5mdReader reader(scratch / "t.h5md");
        store::StoredFrame found;
        for (const std::size_t k : {3, 1, 0}) {
            reader.read(k, found);
            CHECK(is_frame(found, samples, k));
        }
    }
    check_refused({{"the orientation of rod 0 is 0", [](const Hdf5Edit& f) {
                        for (std::size_t c = 0; c < 4; ++c)
                            f.set(rods + "orientation/value", c, 0.0);
                    }}});
}

TEST_CASE("What was never written is not taken for zeros") {
    check_refused({{group + "position/value is not complete", [](const Hdf5Edit& f) {
                        for (const char* name : {"position/step", "position/time", "box/edges/value",
                                                 "position/value", "image/value", "velocity/value"})
                            f.resize(group + name, 5);
                        f.set(group + "position/step", 4, 2000);
                        f.set(group + "position/time", 4, 0.04);
                        for (const std::size_t side : {0, 4, 8})
                            f.set(group + "box/edges/value", 9 * 4 + side, side == 8 ? 0.0014 : 0.0312);
                    }}});
    // A shape that no memory holds.
    check_refused({{group + "position/step is not complete",
                    [](const Hdf5Edit& f) { f.resize(group + "position/step", hsize_t{1} << 50); }}});
}

TEST_CASE("A damaged chunk is an error of its frame alone") {
    const Scratch scratch;
    const SampleFrames samples;
    write_h5md(scratch / "t.h5md", samples, true);
    const auto [address, size] = Hdf5Edit(scratch / "t.h5md").chunk(group + "velocity/value", 1);
    std::string bytes = content(scratch / "t.h5md");
    bytes.replace(address, size, size, 'x');
    scratch.file("t.h5md", bytes);
    store::H5mdReader reader(scratch / "t.h5md");
    store::StoredFrame frame;
    const std::string text = error_of<InputError>([&] { reader.read(1, frame); });
    CHECK(has(text, "velocity/value cannot be read from row 1 on"));
    CHECK(has(text, "damaged"));
    reader.read(2, frame);
    CHECK(is_frame(frame, samples, 2));
}

TEST_CASE("A trajectory cut short anywhere is refused or whole") {
    const Scratch scratch;
    const SampleFrames samples;
    write_h5md(scratch / "whole", samples);
    const std::string whole = content(scratch / "whole");
    std::size_t refused = 0, tried = 0;
    for (std::size_t length = 0; length < whole.size(); length += length < 3000 ? 7 : 211) {
        scratch.file("cut", whole.substr(0, length));
        ++tried;
        try {
            const bool whole_after_all = holds(scratch / "cut", samples);
            CHECK(whole_after_all);
        } catch (const InputError& error) {
            CHECK(has(error.what(), (scratch / "cut").string() + ": "));
            ++refused;
        }
    }
    CHECK(tried > 500);
    CHECK(refused == tried);
    scratch.file("cut", whole.substr(0, whole.size() / 2));
    CHECK(has(error_of<InputError>([&] { holds(scratch / "cut", samples); }), "cut short or damaged"));
    scratch.file("cut", whole);
    CHECK(holds(scratch / "cut", samples));
}

TEST_CASE("Failures print nothing of their own") {
    const Scratch scratch;
    write_h5md(scratch / "t.h5md", SampleFrames());
    Hdf5Edit(scratch / "t.h5md").remove(group + "mass");
    scratch.file("text", "text");
    const auto fail = [&] {
        for (const char* name : {"t.h5md", "text", "none"})
            error_of<InputError>([&] { store::H5mdReader(scratch / name); });
    };
    CHECK(printed_to_error(fail).empty());
}

TEST_CASE("A file damaged at any place is read or refused, soon and within a gigabyte") {
    const Scratch scratch;
    write_h5md(scratch / "whole", SampleFrames());
    std::ifstream stored(scratch / "whole", std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(stored), {}};
    RandomStream random(3);
    const auto any = [&](std::size_t count) {
        return static_cast<std::size_t>(random.uniform() * double(count));
    };
    for (int k = 0; k < 200; ++k) {
        std::string damaged = whole;
        const std::size_t at = any(whole.size() - 8), length = std::size_t{1} << any(4);
        for (std::size_t i = at; i < at + length; ++i)
            damaged[i] = k % 3 == 0 ? '\xff' : k % 3 == 1 ? '\0' : static_cast<char>(any(256));
        CAPTURE(k, at, length);
        scratch.file("damaged", damaged);
        const auto start = std::chrono::steady_clock::now();
        try {
            holds(scratch / "damaged", SampleFrames());
        } catch (const InputError&) {
        } catch (const RunError&) {
        }
        CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
    }
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    CHECK(used.ru_maxrss < 1'000'000); // kB
}
