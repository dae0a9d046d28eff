// Trajectories read back: bit for bit what was written, in any order.

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
