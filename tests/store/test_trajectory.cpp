// Trajectory files: whole or not there, refused input, full disks. What is in them is checked by other
// readers in test_trajectory.py, on the files that the last test here makes.

#include "rodwake/store/extended_xyz.hpp"
#include "rodwake/store/h5md.hpp"
#include "rodwake/store/hdf5_reader.hpp"

#include "sample_frames.hpp"
#include "scratch.hpp"
#include "small_disk.hpp"

#include <catch2/catch.hpp>

#include <bit>
#include <cstdlib>
#include <sstream>

using namespace rodwake;
using namespace store_test;

using Names = std::set<std::string>;

namespace {

store::H5mdInfo sample_info(bool deflate = false) {
    return {"A. Author",
            "9.8.7",
            "rodwake dem \"zwei Stäbe.toml\"",
            18446744073709551615U,
            {{"time_step", 2e-5}},
            {{"note", ""}},
            deflate};
}

template<class Writer>
void add_all(Writer& out, const SampleFrames& samples) {
    for (std::size_t k = 0; k < samples.frames.size(); ++k)
        out.add_frame(samples.frame(k));
}

void write_h5md(const fs::path& path, const SampleFrames& samples, bool deflate = false) {
    store::H5mdWriter out(path, samples.layout, sample_info(deflate));
    add_all(out, samples);
    out.commit();
}

void write_xyz(const fs::path& path, const SampleFrames& samples, double unit = 1.0) {
    store::ExtendedXyzWriter out(path, samples.layout, unit);
    add_all(out, samples);
    out.commit();
}

/// The same run without its rods.
SampleFrames without_rods() {
    SampleFrames samples;
    auto& layout = samples.layout;
    layout.rod_id.clear();
    layout.rod_mass.clear();
    layout.rod_of_sphere.clear();
    layout.species.assign(layout.species.size(), 0);
    for (auto& frame : samples.frames)
        frame.rod_position = frame.rod_velocity = frame.rod_orientation = frame.rod_angular_momentum = {};
    return samples;
}

/// Numbers of beads, each frame, so that a file is large.
SampleFrames large(std::size_t particles) {
    SampleFrames samples = without_rods();
    auto& layout = samples.layout;
    layout.species.assign(particles, 0);
    layout.mass.assign(particles, 1.0);
    layout.radius.assign(particles, 1.0);
    layout.id.resize(particles);
    for (std::size_t i = 0; i < particles; ++i)
        layout.id[i] = static_cast<std::int32_t>(i);
    for (auto& frame : samples.frames)
        frame.position = frame.velocity = std::vector<double>(3 * particles, 0.01);
    return samples;
}

} // namespace

TEST_CASE("An H5MD file has what it should have") {
    const Scratch scratch;
    write_h5md(scratch / "t.h5md", SampleFrames());
    CHECK(scratch.entries() == Names{"t.h5md"});
    const std::string text = store::list_hdf5(scratch / "t.h5md");
    INFO(text);
    for (const char* line :
         {"/h5md/creator  name = \"rodwake\"  version = \"9.8.7\"\n",
          "/particles/trajectory/position/value [4][15][3]\n", "/particles/trajectory/species [15]\n",
          "/particles/trajectory/box/edges/value [4][3][3]\n",
          "/particles/trajectory_rods/orientation/value [4][2][4]\n", "/observables/plate_z/value [4]\n",
          "/parameters  time_step = 2e-05\n", "/parameters/rod_of_sphere [6]\n",
          "/particles/trajectory/box  boundary = \"periodic\", \"periodic\", \"none\"  dimension = 3\n"})
        CHECK(has(text, line));
    CHECK(has(text, "command = \"rodwake dem \"zwei Stäbe.toml\"\""));
}

TEST_CASE("Without rods there is no group of rods") {
    const Scratch scratch;
    write_h5md(scratch / "t.h5md", without_rods());
    const std::string text = store::list_hdf5(scratch / "t.h5md");
    CHECK(has(text, "/particles/trajectory/position/value [4][15][3]\n"));
    CHECK_FALSE(has(text, "trajectory_rods"));
    CHECK_FALSE(has(text, "rod_of_sphere"));
}

TEST_CASE("Trajectories appear at commit; without it the old file stands") {
    const Scratch scratch;
    const SampleFrames samples;
    scratch.file("a", "old");
    {
        store::H5mdWriter h5md(scratch / "a", samples.layout, sample_info());
        add_all(h5md, samples);
    }
    {
        store::ExtendedXyzWriter xyz(scratch / "a", samples.layout);
        add_all(xyz, samples);
    }
    CHECK(content(scratch / "a") == "old");
    CHECK(scratch.entries() == Names{"a"});
}

TEST_CASE("What is no trajectory is refused by both writers, and nothing is left") {
    const Scratch scratch;
    SampleFrames samples;
    store::FrameLayout bad = samples.layout;
    bad.id.clear();
    CHECK(has(error_of<InputError>([&] { store::H5mdWriter(scratch / "a", bad, {}); }), "ids, expected"));
    CHECK(has(error_of<InputError>([&] { store::ExtendedXyzWriter(scratch / "a", bad); }), "ids, expected"));
    for (const double unit : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL})
        CHECK(
            has(error_of<InputError>([&] { store::ExtendedXyzWriter(scratch / "a", samples.layout, unit); }),
                "length unit"));
    samples.frames[1].step = samples.frames[0].step;
    const auto twice = [&](auto& out) { return error_of<RunError>([&] { add_all(out, samples); }); };
    {
        store::H5mdWriter h5md(scratch / "a", samples.layout, sample_info());
        CHECK(has(twice(h5md), "step 0 after step 0"));
        store::ExtendedXyzWriter xyz(scratch / "b", samples.layout);
        CHECK(has(twice(xyz), "step 0 after step 0"));
    }
    CHECK(scratch.entries().empty());
    CHECK(has(error_of<RunError>([&] { write_h5md(scratch / "none/a", samples); }), "No such file"));
    CHECK(has(error_of<RunError>([&] { write_xyz(scratch / "none/a", samples); }), "No such file"));
}

TEST_CASE("A full disk is reported with the system's reason, and the old trajectory stands") {
    const Scratch scratch;
    const SampleFrames samples = large(3000); // about 170 kB a frame
    scratch.file("t.h5md", "old");
    scratch.file("t.xyz", "old");
    for (const rlim_t bytes : {0, 1000, 50000, 200000, 400000}) {
        CAPTURE(bytes);
        const std::string h5md = on_small_disk(bytes, [&] { write_h5md(scratch / "t.h5md", samples); });
        const std::string xyz = on_small_disk(bytes, [&] { write_xyz(scratch / "t.xyz", samples); });
        CHECK(has(h5md, "File too large"));
        CHECK(xyz == (scratch / "t.xyz").string() + ": cannot write: File too large");
    }
    CHECK(content(scratch / "t.h5md") == "old");
    CHECK(content(scratch / "t.xyz") == "old");
    CHECK(scratch.entries() == Names{"t.h5md", "t.xyz"});
    CHECK(on_small_disk(10000000, [&] { write_h5md(scratch / "t.h5md", samples); }) == "done");
    CHECK(on_small_disk(10000000, [&] { write_xyz(scratch / "t.xyz", samples); }) == "done");
}

TEST_CASE("Extended XYZ is what the format says, to the last bit") {
    const Scratch scratch;
    const SampleFrames samples;
    write_xyz(scratch / "t.xyz", samples);
    std::ifstream in(scratch / "t.xyz");
    std::string line, symbol;
    for (std::size_t k = 0; k < samples.frames.size(); ++k) {
        std::getline(in, line);
        CHECK(line == "15");
        std::getline(in, line);
        CHECK(has(line,
                  "Lattice=\"0.0312 0 0 0 0.0312 0 0 0 0.0014\" Properties=species:S:1:pos:R:3:velo:R:3:"
                  "id:I:1:molecule:I:1:radius:R:1:kind:S:1 pbc=\"T T F\" Time="));
        CHECK(has(line, " Step=" + std::to_string(samples.frames[k].step) + " kinetic_energy="));
        const auto place = store::wrap(samples.frames[k].position, samples.layout).place;
        for (std::size_t i = 0; i < 15; ++i) {
            std::getline(in, line);
            std::istringstream fields(line);
            fields >> symbol;
            for (std::size_t c = 0; c < 6; ++c) {
                std::string number;
                fields >> number;
                const double wanted = c < 3 ? place[3 * i + c] : samples.frames[k].velocity[3 * i + c - 3];
                CHECK(std::bit_cast<std::uint64_t>(std::strtod(number.c_str(), nullptr)) ==
                      std::bit_cast<std::uint64_t>(wanted));
            }
            CHECK(symbol + line.substr(line.rfind(' ')) == (i < 9 ? "Al bead" : "Cu rod"));
        }
    }
    CHECK_FALSE(std::getline(in, line));
}

/// RODWAKE_SAMPLES names a folder: the sample trajectories in both formats, and what they were made from as
/// numbers.
TEST_CASE("Sample files for other readers", "[.][samples]") {
    const char* name = std::getenv("RODWAKE_SAMPLES");
    REQUIRE(name);
    const fs::path folder = name;
    const SampleFrames samples;
    write_h5md(folder / "sample.h5md", samples);
    write_h5md(folder / "deflated.h5md", samples, true);
    write_h5md(folder / "no_rods.h5md", without_rods());
    write_xyz(folder / "sample.xyz", samples);
    write_xyz(folder / "radii.xyz", samples, 4e-4);
    std::ofstream truth(folder / "truth.txt");
    truth.precision(17);
    const auto print = [&](const char* what, const std::vector<double>& values) {
        truth << what;
        for (const double value : values)
            truth << ' ' << value;
        truth << '\n';
    };
    for (const auto& frame : samples.frames) {
        print("time", {frame.time});
        print("position", frame.position);
        print("velocity", frame.velocity);
        print("rod_position", frame.rod_position);
        print("rod_velocity", frame.rod_velocity);
        print("rod_orientation", frame.rod_orientation);
        print("rod_angular_momentum", frame.rod_angular_momentum);
        print("observables", frame.observables);
    }
}
