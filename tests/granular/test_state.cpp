// The hash sees every number of a state; headings are in (-pi, pi].

#include "rodwake/granular/state.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>

using namespace rodwake;
using granular::State;

namespace {

State some_state() {
    State state;
    state.step = 7;
    state.beads.resize(3);
    for (auto* array : {&state.beads.x, &state.beads.y, &state.beads.z, &state.beads.vx, &state.beads.vy,
                        &state.beads.vz, &state.beads.wx, &state.beads.wy, &state.beads.wz})
        *array = {0.5, 0.25, 0.125};
    state.rods.resize(2);
    return state;
}

/// Pointers to all numbers of a state.
std::vector<double*> numbers(State& state) {
    std::vector<double*> all;
    auto& b = state.beads;
    for (auto* array : {&b.x, &b.y, &b.z, &b.vx, &b.vy, &b.vz, &b.wx, &b.wy, &b.wz})
        for (double& number : *array)
            all.push_back(&number);
    for (auto& rod : state.rods) {
        for (int k = 0; k < 3; ++k)
            all.insert(all.end(), {&rod.position[k], &rod.velocity[k], &rod.angular_momentum[k]});
        for (int k = 0; k < 4; ++k)
            all.push_back(&rod.orientation.coeffs()[k]);
    }
    return all;
}

granular::RodBody turned(double angle) {
    granular::RodBody rod;
    rod.orientation = Eigen::Quaterniond(std::cos(0.5 * angle), 0.0, 0.0, std::sin(0.5 * angle));
    return rod;
}

} // namespace

TEST_CASE("every number changes the hash, by its last bit") {
    State state = some_state();
    std::set<std::uint64_t> seen{state_hash(state)};
    CHECK(state_hash(some_state()) == *seen.begin());
    const auto all = numbers(state);
    REQUIRE(all.size() == 3 * 9 + 2 * 13);
    for (double* number : all) {
        const double before = *number;
        *number = std::nextafter(before, 2.0);
        CHECK(seen.insert(state_hash(state)).second);
        *number = before;
    }
    state.step = 8;
    CHECK(seen.insert(state_hash(state)).second);
    state.step = 7;
    state.beads.x[0] = 0.0;
    seen.insert(state_hash(state));
    state.beads.x[0] = -0.0; // equal as a number, not as a state
    CHECK(seen.insert(state_hash(state)).second);
}

TEST_CASE("resizing keeps all arrays of one length and fills with rest") {
    granular::Beads beads;
    beads.resize(5);
    for (const auto* array :
         {&beads.x, &beads.y, &beads.z, &beads.vx, &beads.vy, &beads.vz, &beads.wx, &beads.wy, &beads.wz})
        CHECK(*array == std::vector<double>(5, 0.0));
    beads.resize(2);
    CHECK(beads.size() == 2);
    CHECK(beads.wz.size() == 2);
}

TEST_CASE("a heading is the angle of the axis' shadow") {
    for (const double angle : {0.0, 0.3, -2.0, 3.0})
        CHECK(turned(angle).heading() == Approx(angle).margin(1e-15)); // rounding
    CHECK(turned(4.0).heading() == Approx(4.0 - 2.0 * M_PI));
    granular::RodBody back; // axis (-1, -0, 0) exactly: still +pi
    back.orientation = Eigen::Quaterniond(0.0, 0.0, 0.0, 1.0);
    CHECK(back.heading() == M_PI);
    back.orientation = Eigen::Quaterniond(0.0, 0.0, 0.0, -1.0);
    CHECK(back.heading() == M_PI);
    auto pitched = turned(0.7); // thin end up by 0.2 rad: the shadow stays
    pitched.orientation = pitched.orientation * Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY());
    CHECK(pitched.axis().z() > 0.1);
    CHECK(pitched.heading() == Approx(0.7).epsilon(1e-14));
}
