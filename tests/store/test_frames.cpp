// Layouts and frames that are none are refused; wrapping loses nothing that can be kept.

#include "rodwake/store/frames.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "sample_frames.hpp"
#include "scratch.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace rodwake;
using namespace store_test;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

template<class Change>
std::string layout_refusal(Change change) {
    store::FrameLayout layout = SampleFrames().layout;
    change(layout);
    return error_of<InputError>([&] { store::check_layout(layout); });
}

template<class Change>
std::string frame_refusal(Change change, std::int64_t after = -1) {
    SampleFrames samples;
    change(samples);
    return error_of<RunError>([&] { store::check_frame(samples.layout, samples.frame(0), after); });
}

} // namespace

TEST_CASE("The sample is a layout with frames") {
    SampleFrames samples;
    CHECK_NOTHROW(store::check_layout(samples.layout));
    CHECK_NOTHROW(store::check_frame(samples.layout, samples.frame(0), -1));
}

TEST_CASE("Layouts that are none say why") {
    using L = store::FrameLayout;
    CHECK(has(layout_refusal([](L& l) { l = {}; }), "no particles"));
    CHECK(has(layout_refusal([](L& l) { l.id.pop_back(); }), "ids, expected"));
    CHECK(has(layout_refusal([](L& l) { l.id[1] = l.id[0]; }), "ids are not distinct"));
    CHECK(has(layout_refusal([](L& l) { l.mass[0] = not_a_number; }),
              "a mass = nan: must be finite and positive"));
    CHECK(has(layout_refusal([](L& l) { l.radius.push_back(1.0); }), "radii, expected"));
    CHECK(has(layout_refusal([](L& l) { l.radius[0] = 0.0; }), "a radius = 0"));
    CHECK(has(layout_refusal([](L& l) { l.box[2] = 0.0; }), "a side of the box = 0"));
    CHECK(has(layout_refusal([](L& l) { l.species[0] = 1; }), "owners of the spheres of rods, expected"));
    CHECK(
        has(layout_refusal([](L& l) { l.species.back() = 2; }), "a species = 2: must be from 0 to below 2"));
    CHECK(has(layout_refusal([](L& l) { l.rod_of_sphere[0] = 9; }), "the rod of a sphere = 9"));
    CHECK(has(layout_refusal([](L& l) { l.rod_mass.clear(); }), "masses of rods, expected"));
    for (const char* name : {"", "a b", "a/b", ".", "a=b", "Stäbe"})
        CHECK(has(layout_refusal([&](L& l) { l.observables[0] = name; }), "is no name"));
    CHECK(has(layout_refusal([](L& l) { l.observables[0] = "Step"; }), "the formats use it"));
    CHECK(has(layout_refusal([](L& l) { l.observables[0] = l.observables[1]; }), "not distinct"));
    CHECK(has(layout_refusal([](L& l) { l.kinds[0].name = "a b"; }), "is no name"));
}

TEST_CASE("Frames that do not fit say why") {
    using S = SampleFrames;
    CHECK(has(frame_refusal([](S&) {}, 0), "step 0 after step 0"));
    CHECK(has(frame_refusal([](S& s) { s.frames[0].position.pop_back(); }),
              "components of positions, expected"));
    CHECK(has(frame_refusal([](S& s) { s.frames[0].velocity[1] = not_a_number; }),
              "velocities that are not finite"));
    CHECK(has(frame_refusal([](S& s) { s.frames[0].rod_orientation.clear(); }), "orientations, expected"));
    CHECK(has(frame_refusal([](S& s) { s.frames[0].observables.push_back(1.0); }), "observables, expected"));
    CHECK(has(frame_refusal([](S& s) { s.frames[0].time = not_a_number; }), "times that are not finite"));
}

TEST_CASE("Wrapping is exact where it can be") {
    const double side = 0.0312, ulp = std::nextafter(side, 1.0) - side;
    RandomStream random(3);
    for (int i = 0; i < 100000; ++i) {
        const double x = random.uniform(-1.0, 1.0) * std::exp2(random.uniform(-80.0, 20.0));
        const auto [place, image] = store::wrap(x, side);
        REQUIRE((place >= 0.0 && place < side));
        // fma rounds once, to a number below side; long double adds the error of its own product, 2^-64 |x|.
        const long double back = static_cast<long double>(side) * image + place;
        REQUIRE(std::abs(static_cast<double>(back - x)) <= 0.5 * ulp + 0x1p-62 * std::abs(x));
        if (x >= 0.0 && x < side)
            REQUIRE((image == 0 && place == x));
    }
}

TEST_CASE("Wrapping at the edges of the box") {
    const double side = 0.1, below = std::nextafter(side, 0.0);
    for (const double k : {-3.0, -1.0, 0.0, 1.0, 3.0, 1e6})
        for (const double x : {std::nextafter(k * side, -1e9), k * side, std::nextafter(k * side, 1e9)}) {
            const auto [place, image] = store::wrap(x, side);
            CHECK((place >= 0.0 && place < side));
            CHECK(std::abs(std::fma(side, image, place) - x) <= (side - below) * (1 + std::abs(k)));
        }
    CHECK(store::wrap(-1e-300, side).place == 0.0);
    CHECK(store::wrap(-1e-300, side).image == 0);
    for (const double x : {not_a_number, HUGE_VAL, -1e300, 1.2e8})
        CHECK(has(error_of<RunError>([&] { store::wrap(x, side); }), "is not near the box of side 0.1"));
}

TEST_CASE("Directions that are not periodic stay as they are") {
    store::FrameLayout layout;
    layout.box = {1.0, 2.0, 3.0};
    const std::vector<double> position = {1.5, -0.5, 7.0};
    const auto wrapped = store::wrap(position, layout);
    CHECK(wrapped.place == std::vector<double>{0.5, 1.5, 7.0});
    CHECK(wrapped.image == std::vector<std::int32_t>{1, -1, 0});
}
