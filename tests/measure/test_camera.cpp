#include "rodwake/core/error.hpp"
#include "rodwake/measure/camera.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>

using namespace rodwake::measure;
using Catch::Contains;

namespace {

constexpr double side = 20.0;

Layout bed(std::size_t beads, std::size_t rods = 0) {
    return {.box = {side, side}, .bead_radius = 1.0, .bead_mass = 1.0, .beads = beads, .rods = rods};
}

/// Beads at these unwrapped places.
Frame frame_of(const std::vector<double>& x, const std::vector<double>& y) {
    Frame frame;
    frame.unwrapped_x = x;
    frame.unwrapped_y = y;
    for (std::size_t i = 0; i < x.size(); ++i) {
        frame.x.push_back(x[i] - side * std::floor(x[i] / side));
        frame.y.push_back(y[i] - side * std::floor(y[i] / side));
    }
    return frame;
}

Frame many(std::size_t beads) {
    return frame_of(std::vector<double>(beads, 7.0), std::vector<double>(beads, 9.0));
}

} // namespace

TEST_CASE("A camera without faults has the bits of the bed, in pixels", "[camera]") {
    Film film({.pixel = 0.5}, bed(3, 1));
    Frame frame = frame_of({0.1, 33.3, -1e-3}, {7.7, 19.99, 5.0});
    frame.rods = {{-4.0, 26.0, 0.7}};
    REQUIRE(film.expose(frame));
    REQUIRE(film.spots().size() == 4);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(film.spots()[i].particle == i);
        CHECK(film.spots()[i].x == frame.x[i] / 0.5);
        CHECK(film.spots()[i].y == frame.y[i] / 0.5);
        CHECK(std::isnan(film.spots()[i].heading));
    }
    CHECK(film.spots()[3].x == 16.0 / 0.5);
    CHECK(film.spots()[3].y == 6.0 / 0.5);
    CHECK(film.spots()[3].heading == 0.7);
}

TEST_CASE("A turned and distorted camera sees what lies in its picture", "[camera]") {
    const double turned = 0.3, k = 0.05, view = 0.5;
    Film film({.pixel = 0.1, .view = view, .turned = turned, .distortion = k}, bed(3, 1));
    Frame frame = frame_of({13.0, 10.0, 1.0}, {11.0, 10.0, 1.0}); // the last lies outside
    frame.rods = {{9.0, 12.0, 1.0}};
    REQUIRE(film.expose(frame));
    REQUIRE(film.spots().size() == 3);
    const double far = (9.0 + 1.0) / (2.0 * 5.0 * 5.0); // r^2 over the picture's half diagonal squared
    const double x = (1.0 + k * far) * (3.0 * std::cos(turned) + 1.0 * std::sin(turned)),
                 y = (1.0 + k * far) * (1.0 * std::cos(turned) - 3.0 * std::sin(turned));
    CHECK(film.spots()[0].x == Approx((5.0 + x) / 0.1).epsilon(1e-14)); // rounding of some operations
    CHECK(film.spots()[0].y == Approx((5.0 + y) / 0.1).epsilon(1e-14));
    CHECK(film.spots()[1].x == Approx(50.0).epsilon(1e-14));
    CHECK(film.spots()[2].heading == Approx(1.0 - turned).epsilon(1e-14));
}

TEST_CASE("An exposure has the mean place, also across the box's edge", "[camera]") {
    Film film({.pixel = 1.0, .every = 3, .exposure = 2}, bed(1));
    CHECK_FALSE(film.expose(frame_of({19.5}, {1.0})));
    REQUIRE(film.expose(frame_of({21.5}, {3.0})));
    CHECK(film.spots()[0].x == Approx(0.5).epsilon(1e-14));
    CHECK(film.spots()[0].y == Approx(2.0).epsilon(1e-14));
    CHECK_FALSE(film.expose(frame_of({22.0}, {3.0})));
    CHECK_FALSE(film.expose(frame_of({22.0}, {3.0})));
    CHECK(film.expose(frame_of({22.0}, {3.0})));
    CHECK(film.pictures() == 2);
}

TEST_CASE("Spots that are lost and the noise of their places have the size asked for", "[camera]") {
    const std::size_t beads = 20000;
    Film film({.pixel = 1.0, .lost = 0.3, .noise = 0.2}, bed(beads));
    REQUIRE(film.expose(many(beads)));
    const double found = static_cast<double>(film.spots().size()), n = static_cast<double>(beads);
    CHECK(std::abs(found / n - 0.7) < 5.0 * std::sqrt(0.21 / n)); // binomial
    double square = 0.0, sum = 0.0;
    for (const Spot& spot : film.spots()) {
        square += std::pow(spot.x - 7.0, 2) + std::pow(spot.y - 9.0, 2);
        sum += spot.x - 7.0;
    }
    CHECK(std::abs(square / (2.0 * found) / 0.04 - 1.0) < 5.0 / std::sqrt(found)); // chi squared of 2 n
    CHECK(std::abs(sum / found) < 5.0 * 0.2 / std::sqrt(found));
}

TEST_CASE("The same seed has the same film, another one another", "[camera]") {
    const auto spots = [](std::uint64_t seed) {
        Film film({.pixel = 1.0, .lost = 0.5, .noise = 0.1, .seed = seed}, bed(50));
        film.expose(many(50));
        std::set<std::pair<double, double>> places;
        for (const Spot& spot : film.spots())
            places.emplace(spot.x, spot.y);
        return places;
    };
    CHECK(spots(1) == spots(1));
    CHECK(spots(1) != spots(2));
}

TEST_CASE("A particle that was away for long gets another number", "[camera]") {
    for (const std::size_t memory : {0U, 1U, 2U}) {
        Film film({.pixel = 1.0, .view = 0.5, .memory = memory}, bed(2));
        const Frame here = frame_of({10.0, 9.0}, {10.0, 9.0}), away = frame_of({1.0, 9.0}, {1.0, 9.0});
        for (const Frame* frame : {&here, &away, &away, &here})
            film.expose(*frame);
        CHECK(film.spots()[0].particle == (memory < 2 ? 2U : 0U)); // away in two pictures
        CHECK(film.spots()[1].particle == 1U);
    }
}

TEST_CASE("Cameras that there are not", "[camera]") {
    const auto refused = [](const Camera& camera, const std::string& why) {
        CHECK_THROWS_WITH(Film(camera, bed(1)), Contains(why));
        CHECK_THROWS_AS(Film(camera, bed(1)), rodwake::InputError);
    };
    refused({.pixel = 0.0}, "pixel = 0: must be above 0");
    refused({.pixel = 1.0, .every = 2, .exposure = 3}, "exposure = 3");
    refused({.pixel = 1.0, .view = 1.5}, "view = 1.5");
    refused({.pixel = 1.0, .turned = 0.1}, "beyond the box; take 0.913 or less"); // 1/(cos 0.1 + sin 0.1)
    refused({.pixel = 1.0, .view = 0.5, .distortion = 0.3}, "distortion = 0.3");
    refused({.pixel = 1.0, .lost = 1.0}, "lost = 1");
    refused({.pixel = 1.0, .noise = -1.0}, "noise = -1");
    refused({.pixel = 1.0, .view = NAN}, "view");
}

TEST_CASE("A camera sees all of a dish, or a picture within", "[camera]") {
    Layout dish = bed(1);
    dish.window = room_within(true, side, 1.0);
    CHECK_FALSE(seen_by({.pixel = 1.0}, bed(1)));
    CHECK(seen_by({.pixel = 1.0, .turned = 0.4}, dish) == Window::circle(10.0, 10.0, 9.1));
    const Window barrel = *seen_by({.pixel = 1.0, .distortion = -0.1}, dish);
    CHECK(barrel.radius == Approx(9.1 * (1.0 - 0.1 * 9.1 * 9.1 / 200.0)).epsilon(1e-14)); // rounding
    CHECK(seen_by({.pixel = 1.0, .view = 0.6}, dish) == Window::rectangle(0.0, 0.0, 12.0, 12.0));
    CHECK_THROWS_WITH(Film({.pixel = 1.0, .view = 0.7}, dish),
                      Contains("take 0.643 or less, or all of the dish"));
    CHECK_THROWS_WITH(Film({.pixel = 1.0, .distortion = 0.1}, dish), Contains("take 0.643 or less"));
    Layout tray = bed(1);
    tray.window = room_within(false, side, 1.0);
    CHECK(seen_by({.pixel = 1.0}, tray) == tray.window);
    CHECK_THROWS_WITH(Film({.pixel = 1.0, .turned = 0.1}, tray),
                      Contains("beyond the bed; take 0.831 or less"));
    Film film({.pixel = 1.0, .noise = 0.5}, dish); // no image beyond the wall
    double least = 1.0;
    for (int i = 0; i < 100; ++i) {
        REQUIRE(film.expose(frame_of({0.95}, {10.0})));
        least = std::min(least, film.spots()[0].x);
    }
    CHECK(least < 0.5);
    CHECK(least > -2.0); // 5.9 standard deviations
}

namespace {

/// What a picture shows of the discs: sums over its pixels of value - background, and their first moments.
struct Light {
    double sum = 0.0, x = 0.0, y = 0.0;
};

Light light_of(Sensor& sensor, std::span<const Disc> discs) {
    sensor.expose(discs);
    const std::vector<std::uint8_t> grey = sensor.develop();
    Light light;
    for (std::size_t k = 0; k < grey.size(); ++k) {
        const double value = grey[k] / 220.0 - 0.1;
        light.sum += value;
        light.x += value * (static_cast<double>(k % sensor.width()) + 0.5);
        light.y += value * (static_cast<double>(sensor.height() - 1 - k / sensor.width()) + 0.5);
    }
    light.x /= light.sum;
    light.y /= light.sum;
    return light;
}

} // namespace

TEST_CASE("A picture shows discs of their size where they are", "[camera]") {
    Sensor sensor({.pixel = 0.05, .photons = 1e9}, bed(1));
    REQUIRE(sensor.width() == 400);
    const Disc bead{.x = 13.02, .y = 4.51, .radius = 1.0};
    const Light one = light_of(sensor, {{bead}});
    const auto area = [](double radius) { return M_PI * (radius * radius + 1.0); }; // blurred by a pixel
    CHECK(one.sum == Approx(0.9 * area(20.0)).epsilon(3e-4)); // grey values are whole numbers
    CHECK(one.x == Approx(13.02 / 0.05).margin(0.02));
    CHECK(one.y == Approx(4.51 / 0.05).margin(0.02));
    const Disc below{.x = bead.x, .y = bead.y, .radius = 0.5, .value = 0.5};
    CHECK(light_of(sensor, {{below, bead}}).sum == Approx(one.sum).epsilon(1e-3));
    CHECK(light_of(sensor, {{below}}).sum == Approx(0.4 * area(10.0)).epsilon(3e-3));
    sensor.expose({{bead}});
    CHECK(light_of(sensor, {}).sum == Approx(0.5 * one.sum).epsilon(2e-3)); // there in one frame of two
}

TEST_CASE("Photons are counted with the noise that they have", "[camera]") {
    const double photons = 50.0, pixels = 400.0 * 400.0;
    Sensor sensor({.pixel = 0.05, .photons = photons}, bed(1));
    sensor.expose({{{.x = 10.0, .y = 10.0, .radius = 20.0, .value = 0.5}}});
    double mean = 0.0, square = 0.0;
    for (const std::uint8_t grey : sensor.develop()) {
        mean += grey / 220.0 / pixels;
        square += grey / 220.0 * grey / 220.0 / pixels;
    }
    const double variance = 0.5 / photons; // its own error: a share sqrt(2/pixels) = 0.35 %, rounding 0.02 %
    CHECK(mean == Approx(0.5).margin(4.0 * std::sqrt(variance / pixels)));
    CHECK(square - mean * mean == Approx(variance).epsilon(0.015));
    CHECK_THROWS_WITH(Sensor({.pixel = 1e-3}, bed(1)), Contains("20000 x 20000 pixels"));
    CHECK_THROWS_WITH(Sensor({.pixel = 0.1, .blur = 0.0}, bed(1)), Contains("blur"));
    CHECK_THROWS_WITH(Sensor({.pixel = 0.1, .photons = 0.5}, bed(1)), Contains("photons"));
}
