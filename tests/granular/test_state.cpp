// The hash sees every number of a state; headings are in (-pi, pi].

#include "rodwake/granular/state.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
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

TEST_CASE("velocities of the spheres are the rates of their positions") {
    const std::vector<granular::Clump> clumps = {granular::make_clump({})};
    const granular::Clump& clump = clumps[0];
    State state;
    state.beads.resize(1);
    state.beads.x[0] = 0.3;
    state.beads.vy[0] = -0.2;
    granular::RodBody rod;
    rod.position = {0.1, 0.2, 0.3};
    rod.velocity = {0.01, -0.02, 0.03};
    rod.orientation = Eigen::Quaterniond(0.9, 0.1, -0.3, 0.2).normalized();
    rod.angular_momentum = clump.transverse_inertia * Eigen::Vector3d(2.0, -1.0, 3.0);
    state.rods = {rod};
    const Eigen::Vector3d axis = rod.axis(), L = rod.angular_momentum;
    const Eigen::Vector3d along = axis * axis.dot(L),
                          spin = along / clump.axial_inertia + (L - along) / clump.transverse_inertia;
    const auto at = [&](double time) {
        State moved = state;
        moved.beads.y[0] += time * state.beads.vy[0];
        moved.rods[0].position += time * rod.velocity;
        moved.rods[0].orientation =
            Eigen::AngleAxisd(time * spin.norm(), spin.normalized()) * rod.orientation;
        return sphere_positions(moved, clumps);
    };
    const double step = 1e-5;
    const auto before = at(-step), after = at(step), rates = sphere_velocities(state, clumps);
    REQUIRE(rates.size() == 3 * (1 + clump.offset.size()));
    REQUIRE(before.size() == rates.size());
    double worst = 0.0, turning = 0.0;
    for (std::size_t k = 0; k < rates.size(); ++k) {
        worst = std::max(worst, std::abs((after[k] - before[k]) / (2.0 * step) - rates[k]));
        turning = std::max(turning, k < 3 ? 0.0 : std::abs(rates[k] - rod.velocity[static_cast<int>(k % 3)]));
    }
    CHECK(worst < 1e-9);   // (spin step)^2 of turning is 1e-12, rounding of 0.3 over the step 1e-11
    CHECK(turning > 1e-3); // m/s: the spin counts
    CHECK(clump.sphere_mass() * static_cast<double>(clump.radius.size()) ==
          Approx(clump.mass).epsilon(1e-15));
}
