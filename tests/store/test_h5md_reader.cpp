// Trajectories read back: bit for bit what was written, in any order.

#include "hdf5_edit.hpp"
#include "rodwake/core/error.hpp"
#include "stored_frames.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace store_test;

TEST_CASE("A trajectory is read back bit for bit") {
    const Scratch scratch;
    for (const bool deflate : {false, true})
        for (const SampleFrames& samples : {SampleFrames(), without_rods()}) {
            write_h5md(scratch / "t.h5md", samples, deflate);
            CHECK(holds(scratch / "t.h5md", samples));
        }
}

TEST_CASE("The comparison of frames sees every difference") {
    const Scratch scratch;
    const SampleFrames samples;
    write_h5md(scratch / "t.h5md", samples);
    store::H5mdReader reader(scratch / "t.h5md");
    store::StoredFrame good;
    reader.read(2, good);
    REQUIRE(is_frame(good, samples, 2));
    CHECK_FALSE(is_frame(good, samples, 1));
    const auto differs = [&](auto change) {
        store::StoredFrame bad = good;
        change(bad);
        return !is_frame(bad, samples, 2);
    };
    const auto next = [](double& value) { value = std::nextafter(value, 1.0); };
    CHECK(differs([](auto& f) { ++f.step; }));
    CHECK(differs([&](auto& f) { next(f.time); }));
    CHECK(differs([&](auto& f) { next(f.x[8]); }));
    CHECK(differs([&](auto& f) { next(f.y[0]); }));
    CHECK(differs([](auto& f) { ++f.image_x[3]; }));
    CHECK(differs([](auto& f) { --f.image_y[4]; }));
    CHECK(differs([&](auto& f) { next(f.vx[5]); }));
    CHECK(differs([&](auto& f) { next(f.vy[6]); }));
    CHECK(differs([](auto& f) { f.x.pop_back(); }));
    CHECK(differs([](auto& f) { f.rods.pop_back(); }));
    CHECK(differs([&](auto& f) { next(f.rods[1].y); }));
    CHECK(differs([](auto& f) { ++f.rods[0].image_x; }));
    CHECK(differs([&](auto& f) { next(f.rods[1].orientation[3]); }));
}

TEST_CASE("What is the same in every frame") {
    const Scratch scratch;
    write_h5md(scratch / "t.h5md", SampleFrames());
    const store::H5mdReader reader(scratch / "t.h5md");
    const store::TrajectoryInfo& info = reader.info();
    CHECK(info.box == std::array<double, 3>{0.0312, 0.0312, 0.0014});
    CHECK(info.particles == 15);
    CHECK(info.beads == 9);
    CHECK(info.rods == 2);
    CHECK(info.bead_radius == 4e-4);
    CHECK(info.bead_mass == 7.2e-7);
    CHECK(info.parameters == std::map<std::string, double>{{"phi_b", 0.8}, {"time_step", 2e-5}});
    CHECK(info.seed == 18446744073709551615U);
    CHECK(info.step == std::vector<std::int64_t>{0, 500, 1000, 1500});
    CHECK(info.time == std::vector<double>{0.0, 0.01, 0.02, 0.03});
    CHECK(info.frames() == 4);
}

TEST_CASE("Frames are read in any order, by several readers, into the same buffers") {
    const Scratch scratch;
    const SampleFrames samples, beads = without_rods();
    write_h5md(scratch / "a", samples);
    write_h5md(scratch / "b", beads);
    store::H5mdReader first(scratch / "a"), second(scratch / "b"), third(scratch / "a");
    store::H5mdReader moved = std::move(first);
    store::StoredFrame frame;
    for (const std::size_t k : {3, 0, 2, 2, 1}) {
        moved.read(k, frame);
        CHECK(is_frame(frame, samples, k));
        second.read(3 - k, frame);
        CHECK(is_frame(frame, beads, 3 - k));
        third.read(k, frame);
        CHECK(is_frame(frame, samples, k));
    }
    CHECK(has(error_of<InputError>([&] { third.read(4, frame); }), "no frame 4: it holds 0 to 3"));
}

namespace {

const std::string beads = "particles/trajectory/", rods = "particles/trajectory_rods/";

std::string refusal(const fs::path& path) {
    return error_of<InputError>([&] { holds(path, SampleFrames()); });
}

} // namespace

TEST_CASE("Bodies whose rows change from frame to frame are followed by their id") {
    const Scratch scratch;
    const fs::path path = scratch / "t.h5md";
    const SampleFrames samples;
    write_h5md(path, samples);
    {
        const Hdf5Edit file(path);
        for (const char* name : {"position/value", "image/value", "velocity/value", "id/value"})
            for (const std::array<int, 3>& at :
                 {std::array{1, 0, 7}, std::array{2, 3, 4}, std::array{2, 4, 8}})
                file.swap(beads + name, at[0], at[1], at[2]);
        for (const char* name : {"position/value", "image/value", "id/value", "orientation/value"})
            file.swap(rods + name, 3, 0, 1);
    }
    CHECK(holds(path, samples));
    { Hdf5Edit(path).remove(beads + "id"); } // rows are bodies then
    CHECK_FALSE(holds(path, samples));
}

TEST_CASE("Ids that are not those of the first frame, or not once, are refused") {
    const Scratch scratch;
    const fs::path path = scratch / "t.h5md";
    const auto refused = [&](const std::function<void(const Hdf5Edit&)>& damage) {
        write_h5md(path, SampleFrames());
        { damage(Hdf5Edit(path)); }
        return refusal(path);
    };
    const std::size_t particles = SampleFrames().layout.particles();
    CHECK(has(refused([&](auto& f) { f.set(beads + "id/value", 2 * particles + 1, 4711); }),
              "frame 2: particles/trajectory/id 4711 is not in frame 0"));
    CHECK(has(refused([&](auto& f) { f.set(beads + "id/value", 0, SampleFrames().layout.id[1]); }),
              "twice in frame 0"));
    CHECK(has(refused([&](auto& f) { f.set(beads + "id/value", particles, SampleFrames().layout.id[1]); }),
              "appears twice"));
    CHECK(has(refused([&](auto& f) { f.swap(beads + "id/value", 1, 0, particles - 1); }),
              "is a bead in one frame"));
    CHECK(has(refused([&](auto& f) {
                  f.replace(beads + "id/value", H5T_STD_I64LE, {4, 3});
              }),
              "is of shape"));
    CHECK(has(refused([&](auto& f) {
                  f.replace(beads + "id", H5T_STD_I64LE, {particles}); // all ones
              }),
              "id 1 appears twice"));
}

TEST_CASE("Units are taken as they are named, and unknown ones refused") {
    const Scratch scratch;
    const fs::path path = scratch / "t.h5md";
    const SampleFrames samples;
    write_h5md(path, samples);
    {
        const Hdf5Edit file(path);
        const auto in = [&](const std::string& name, double factor, const std::string& unit) {
            file.scale(name, factor);
            file.text_attribute(name, "unit", unit);
        };
        in(beads + "position/value", 1e3, "mm");
        in(beads + "position/time", 1e6, "us");
        in(beads + "velocity/value", 1e-3, "nm ps-1");
        in(beads + "box/edges/value", 1e9, "nm");
        in(beads + "radius", 1e6, "um");
        in(beads + "mass", 1e6, "mg");
    }
    store::StoredFrame frame;
    const store::TrajectoryInfo info = [&] {
        store::H5mdReader reader(path);
        reader.read(2, frame);
        return reader.info();
    }();
    const store::WrappedVectors at = store::wrap(samples.frames[2].position, samples.layout);
    // two roundings of a product, 2^-52, and one of the table of factors
    const auto near = [](double found, double wanted) { return std::abs(found / wanted - 1.0) < 1e-15; };
    CHECK(near(info.box[0], 0.0312));
    CHECK(near(info.bead_radius, 4e-4));
    CHECK(near(info.bead_mass, 7.2e-7));
    CHECK(near(frame.time, 0.02));
    CHECK(near(frame.x[3], at.place[9]));
    CHECK(near(frame.vy[3], samples.frames[2].velocity[10]));
    { Hdf5Edit(path).text_attribute(beads + "position/value", "unit", "furlong"); }
    CHECK(has(refusal(path),
              "particles/trajectory/position/value is in the unit \"furlong\", which is not known"));
    { Hdf5Edit(path).text_attribute(beads + "position/value", "unit", "s"); }
    CHECK(has(refusal(path), "known are m, mm, um, nm, Angstrom"));
}
