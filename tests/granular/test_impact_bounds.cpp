// What holds for every impact: no NaN, energy, friction cone, separation, bounded work, no dependence on
// scale.

#include "granular/slip.hpp"
#include "impact_cases.hpp"

#include "rodwake/core/error.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;

namespace {

constexpr double eps = 2.3e-16;

double energy(const Eigen::Matrix3d& k, const Eigen::Vector3d& v) { return 0.5 * v.dot(k.ldlt().solve(v)); }

/// The change of energy is P.(v + w)/2; of what it cancels from, in units of rounding.
bool energy_grows(const ImpactCase& c, const Impact& i) {
    const double change = 0.5 * i.impulse.dot(c.velocity + i.velocity);
    const Eigen::Vector3d size = c.velocity.cwiseAbs() + c.inverse_mass.cwiseAbs() * i.impulse.cwiseAbs();
    return change > 200.0 * eps * i.impulse.cwiseAbs().dot(size);
}

/// What is wrong with the outcome; empty if nothing.
std::string fault(const ImpactCase& c, const Impact& i) {
    if (!i.impulse.allFinite() || !i.velocity.allFinite())
        return "not finite";
    if (!(i.impulse.z() >= 0.0))
        return "pulls";
    // P_t and P_z are sums of up to most_slip_steps terms, each rounded.
    if (i.impulse.head<2>().norm() > c.surface.friction * i.impulse.z() * (1.0 + 200.0 * eps))
        return "outside the friction cone";
    const Eigen::Vector3d size = c.velocity.cwiseAbs() + c.inverse_mass.cwiseAbs() * i.impulse.cwiseAbs();
    if (i.velocity.z() < -200.0 * eps * size.z())
        return "still approaching";
    if (((i.velocity - c.velocity - c.inverse_mass * i.impulse).array().abs() > 4.0 * eps * size.array())
            .any())
        return "velocity is not v + K P";
    return energy_grows(c, i) ? "energy grows" : "";
}

int steps_of(const ImpactCase& c) {
    ImpactProgress at;
    at.speed = c.velocity.head<2>().norm() / -c.velocity.z();
    at.direction = at.speed > 0.0 ? Eigen::Vector2d(c.velocity.head<2>().normalized()) : at.direction;
    const Eigen::Matrix3d k = c.inverse_mass / c.inverse_mass(2, 2);
    follow_impact(ContactTerms(k.topLeftCorner<2, 2>(), k.topRightCorner<2, 1>(), c.surface), at);
    return at.steps;
}

ImpactCase any_case(RandomStream& random, int k) {
    switch (k % (hard_kinds + 5)) {
    case hard_kinds:
        return sphere_case(random);
    case hard_kinds + 1:
        return planar_case(random);
    case hard_kinds + 2:
        return rod_case(random);
    case hard_kinds + 3:
        return general_case(random, 1e3);
    case hard_kinds + 4: { // everything at once
        ImpactCase c = general_case(random, 1e8);
        c.velocity = c.velocity.cwiseProduct(Eigen::Vector3d(random.log_uniform(1e-12, 1e12),
                                                             random.log_uniform(1e-12, 1e12),
                                                             random.log_uniform(1e-12, 1e12)));
        c.surface = {random.log_uniform(1e-6, 1e3), random.uniform()};
        return c;
    }
    default:
        return hard_case(random, k % (hard_kinds + 5));
    }
}

int worst_steps(int cases, std::uint64_t seed) {
    RandomStream random(seed);
    int most = 0;
    for (int k = 0; k < cases; ++k) {
        const ImpactCase c = any_case(random, k);
        const std::string wrong = fault(c, stronge_impact(c.inverse_mass, c.velocity, c.surface));
        if (!wrong.empty()) {
            CAPTURE(k, wrong, c.inverse_mass, c.velocity.transpose(), c.surface.friction,
                    c.surface.restitution);
            CHECK(wrong.empty());
        }
        most = std::max(most, steps_of(c));
    }
    return most;
}

} // namespace

TEST_CASE("every impact ends, keeps to the friction cone and adds no energy") {
    const int most = worst_steps(20000, 3);
    CAPTURE(most);
    CHECK(most * 5 < most_slip_steps); // the limit is no cause of failure
}

TEST_CASE("a million impacts end, keep to the friction cone and add no energy", "[.][long]") {
    const int most = worst_steps(1000000, 4);
    CAPTURE(most);
    CHECK(most * 5 < most_slip_steps);
}

TEST_CASE("the checks of an impact can fail") {
    RandomStream random(5);
    ImpactCase c = rod_case(random);
    c.surface = {0.1, 1.0};
    const Impact good = stronge_impact(c.inverse_mass, c.velocity, c.surface);
    REQUIRE(fault(c, good).empty());
    const auto with = [&](const Eigen::Vector3d& p) {
        return fault(c, {p, c.velocity + c.inverse_mass * p});
    };
    CHECK(with({NAN, 0.0, 1.0}) == "not finite");
    CHECK(with(-good.impulse) == "pulls");
    CHECK(with(0.3 * good.impulse) == "still approaching");
    CHECK(with(1.001 * good.impulse + Eigen::Vector3d(0.2 * good.impulse.z(), 0.0, 0.0)) ==
          "outside the friction cone");
    CHECK(with(Eigen::Vector3d(0.0, 0.0, 3.0 * good.impulse.z())) == "energy grows");
    CHECK(fault(c, {good.impulse, 1.0001 * good.velocity}) == "velocity is not v + K P");
    const double before = energy(c.inverse_mass, c.velocity), after = energy(c.inverse_mass, good.velocity);
    CHECK(after - before == Approx(0.5 * good.impulse.dot(c.velocity + good.velocity)).epsilon(1e-9));
}

TEST_CASE("units do not matter") {
    RandomStream random(6);
    for (int k = 0; k < 200; ++k) {
        const ImpactCase c = rod_case(random);
        const Impact one = stronge_impact(c.inverse_mass, c.velocity, c.surface);
        const double mass = std::ldexp(1.0, 30), speed = std::ldexp(1.0, -20); // powers of 2: to the bit
        const Impact other = stronge_impact(c.inverse_mass / mass, speed * c.velocity, c.surface);
        CHECK(other.impulse == mass * speed * one.impulse);
        CHECK(other.velocity == speed * one.velocity);
    }
}

TEST_CASE("an inverse mass that is none ends in an error, not in a loop") {
    Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
    k(0, 2) = k(2, 0) = 3.0; // q.A^-1 q > 1: friction can pull without end
    CHECK_THROWS_AS(stronge_impact(k, {1.0, 0.0, -1.0}, {1.0, 0.5}), RunError);
    k(0, 0) = NAN;
    CHECK_THROWS_AS(stronge_impact(k, {1.0, 0.5, -1.0}, {1.0, 0.5}), RunError);
}
