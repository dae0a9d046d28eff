// Impacts with closed forms, written out by hand. Tolerance 1e-12 of |P|: what impact.hpp says.
//
// Chung & Ooi (Granular Matter 13 (2011) 643) list eight single-impact benchmarks. Rigid impulses know
// neither contact stiffness nor duration, so of these apply
//   test 3  normal impact of a sphere with a plate for varying restitution: w_z = -e v_z
//   test 4  oblique impact at varying angle: tangential restitution, spin and rebound angle in the sliding
//   regime test 5  oblique impact at constant normal speed and varying tangential speed, sphere-plate test 6
//   a sphere with initial spin and no tangential speed test 7  two identical spheres, oblique with spin; test
//   8 spheres of different size: sliding and sticking limits
// and do not: test 1 (elastic normal impact of two spheres: force against time), test 2 (sphere and rigid
// plate: force against overlap). In tests 4, 5 and 7 at small angles real spheres rebound with a tangential
// velocity that depends on the ratio of stiffnesses (Maw, Barber, Fawcett); the rigid law sticks there: w_t =
// 0.

#include "impact_cases.hpp"

#include "granular/slip.hpp"
#include "rodwake/core/error.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

void check_impulse(const Impact& got, const Vector3d& wanted) {
    CAPTURE(got.impulse.transpose(), wanted.transpose());
    CHECK((got.impulse - wanted).norm() <= 1e-12 * wanted.norm());
}

Matrix3d planar(double xx, double xz, double zz) {
    Matrix3d k = Matrix3d::Zero();
    k(0, 0) = xx, k(1, 1) = 1.0, k(2, 2) = zz, k(0, 2) = k(2, 0) = xz;
    return k;
}

/// Normal impulse from v_z = 0 on that regains e^2 of the work of compression w, at constant dv_z/dp.
double regain(double w, double rate, double e) { return e * std::sqrt(2.0 * w / rate); }

struct Sphere {
    double mass = 2.0, radius = 0.5;
    double k_t() const { return 1.0 / mass + radius * radius / (0.4 * mass * radius * radius); } // 7/(2 m)
    Vector3d velocity(double v_t, double v_n, double spin) const { return {v_t + radius * spin, 0.0, -v_n}; }
    /// After the impulse P on it at its lowest point, r = (0, 0, -R); spin about y such that v_c = v_t + R
    /// spin for the convention spin = -omega_y.
    double centre(double v_t, const Vector3d& p) const { return v_t + p.x() / mass; }
    double spin(double before, const Vector3d& p) const { return before + p.x() / (0.4 * mass * radius); }
};

} // namespace

TEST_CASE("no approach, no impulse") {
    const Matrix3d k = planar(1.0, 0.3, 1.0);
    for (const double v_z : {0.0, 1e-300, 2.0}) {
        const Impact impact = stronge_impact(k, {0.3, 0.0, v_z}, {0.5, 0.5});
        CHECK(impact.impulse == Vector3d::Zero());
        CHECK(impact.velocity == Vector3d(0.3, 0.0, v_z));
    }
}

TEST_CASE("without friction the impulse is normal") {
    RandomStream random(21);
    for (int k = 0; k < 100; ++k) {
        const ImpactCase c = rod_case(random);
        const double e = c.surface.restitution;
        check_impulse(stronge_impact(c.inverse_mass, c.velocity, {0.0, e}),
                      {0.0, 0.0, -(1.0 + e) * c.velocity.z() / c.inverse_mass(2, 2)});
    }
}

TEST_CASE("stick from the start") {
    // No slip, |A^-1 q| = 0.4/2 <= mu: P_t = -0.2 p, dv_z/dp = 1 - 0.4^2/2 = 0.92.
    const Impact impact = stronge_impact(planar(2.0, 0.4, 1.0), {0.0, 0.0, -3.0}, {0.25, 0.6});
    const double p = 1.6 * 3.0 / 0.92; // rate constant: energetic and kinematic restitution are the same
    check_impulse(impact, {-0.2 * p, 0.0, p});
    CHECK(std::abs(impact.velocity.x()) < 1e-15 * 10.0); // a few roundings of K P, of size 1
}

TEST_CASE("slip to the end") {
    // Along +x: dv_z/dp = 1 - 0.1 * 0.4, and the slip is fast.
    const double p = 1.5 * 2.0 / 0.96;
    check_impulse(stronge_impact(planar(2.0, 0.4, 1.0), {50.0, 0.0, -2.0}, {0.1, 0.5}), {-0.1 * p, 0.0, p});
}

TEST_CASE("slip that stops and sticks") {
    // Slip along +x: dv_x/dp = 0.4 - 0.5 * 2 = -0.6, dv_z/dp = 1 - 0.5 * 0.4 = 0.8; stops at p1 = 0.3/0.6 =
    // 0.5 in compression; sticks (0.2 <= 0.5): dv_z/dp = 0.92.
    const double p1 = 0.5, v1 = -3.0 + 0.8 * p1, p2 = -v1 / 0.92;
    const double work = -0.5 * (-3.0 + v1) * p1 - 0.5 * v1 * p2;
    const double p3 = regain(work, 0.92, 0.7), p = p1 + p2 + p3;
    check_impulse(stronge_impact(planar(2.0, 0.4, 1.0), {0.3, 0.0, -3.0}, {0.5, 0.7}),
                  {-0.5 * p1 - 0.2 * (p2 + p3), 0.0, p});
}

TEST_CASE("slip that stops in restitution and sticks") {
    // As above with 2.6 of slip: p1 = 2.6/0.6 > 3/0.8, so compression ends while slipping.
    const double p1 = 2.6 / 0.6, pc = 3.0 / 0.8, v1 = -3.0 + 0.8 * p1;
    const double work = 0.5 * 3.0 * pc, missing = 0.81 * work - 0.5 * v1 * (p1 - pc);
    const double p2 = (-v1 + std::sqrt(v1 * v1 + 2.0 * 0.92 * missing)) / 0.92, p = p1 + p2;
    check_impulse(stronge_impact(planar(2.0, 0.4, 1.0), {2.6, 0.0, -3.0}, {0.5, 0.9}),
                  {-0.5 * p1 - 0.2 * p2, 0.0, p});
}

TEST_CASE("slip that reverses in the plane") {
    // mu = 0.1 < 0.2: along -x dv_x/dp = 0.4 + 0.1 * 2 = 0.6, dv_z/dp = 1 + 0.04; back along +x dv_z/dp =
    // 0.96.
    const double p1 = 0.5, v1 = -3.0 + 1.04 * p1, p2 = -v1 / 0.96;
    const double work = -0.5 * (-3.0 + v1) * p1 - 0.5 * v1 * p2;
    const double p3 = regain(work, 0.96, 0.4);
    check_impulse(stronge_impact(planar(2.0, 0.4, 1.0), {-0.3, 0.0, -3.0}, {0.1, 0.4}),
                  {0.1 * p1 - 0.1 * (p2 + p3), 0.0, p1 + p2 + p3});
}

TEST_CASE("jam: friction presses the bodies together until the slip stops") {
    // q = 0.9, mu = 2: along +x dv_z/dp = 1 - 1.8 = -0.8, dv_x/dp = 0.9 - 2; then stick, 1 - 0.81 = 0.19.
    const double p1 = 0.55 / 1.1, v1 = -1.0 - 0.8 * p1, p2 = -v1 / 0.19;
    const double work = -0.5 * (-1.0 + v1) * p1 - 0.5 * v1 * p2;
    const double p3 = regain(work, 0.19, 0.5);
    check_impulse(stronge_impact(planar(1.0, 0.9, 1.0), {0.55, 0.0, -1.0}, {2.0, 0.5}),
                  {-2.0 * p1 - 0.9 * (p2 + p3), 0.0, p1 + p2 + p3});
}

TEST_CASE("without coupling one closed form is exact") {
    RandomStream random(22);
    for (int k = 0; k < 2000; ++k) {
        const ImpactCase c = sphere_case(random);
        const Impact any = stronge_impact(c.inverse_mass, c.velocity, c.surface);
        const Impact one =
            uncoupled_impact(c.inverse_mass(0, 0), c.inverse_mass(2, 2), c.velocity, c.surface);
        CHECK((any.impulse - one.impulse).norm() <= 1e-13 * one.impulse.norm()); // rounding
        CHECK((any.velocity - one.velocity).norm() <= 1e-13 * c.velocity.norm());
    }
    CHECK(uncoupled_impact(1.0, 1.0, {1.0, 0.0, 0.5}, {0.5, 0.5}).impulse == Vector3d::Zero());
    CHECK(uncoupled_impact(1.0, 2.0, {0.0, 0.0, -1.0}, {0.5, 0.5}).impulse == Vector3d(0.0, 0.0, 0.75));
}

TEST_CASE("test 3 of Chung and Ooi: normal restitution") {
    const Sphere ball;
    for (const double e : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
        const Impact i =
            uncoupled_impact(ball.k_t(), 1.0 / ball.mass, ball.velocity(0.0, 3.9, 0.0), {0.3, e});
        CHECK(i.velocity.z() == Approx(3.9 * e).margin(1e-14));
        CHECK(i.impulse.head<2>() == Eigen::Vector2d::Zero());
    }
}

TEST_CASE("tests 4 and 5 of Chung and Ooi: oblique impact of a sphere on a plate") {
    const Sphere ball;
    const double mu = 0.092, e = 0.98, v_n = 3.9;
    for (int degrees = 1; degrees < 90; ++degrees) {
        const double v_t = v_n * std::tan(degrees * M_PI / 180.0);
        const Matrix3d k = Vector3d(ball.k_t(), ball.k_t(), 1.0 / ball.mass).asDiagonal();
        const Impact i = stronge_impact(k, ball.velocity(v_t, v_n, 0.0), {mu, e});
        const bool slides = v_t / v_n > 3.5 * mu * (1.0 + e); // 7/2 mu (1 + e)
        // Sliding: v_t' = v_t - mu (1 + e) v_n, omega' = -5/2 mu (1 + e) v_n/R. Sticking: 5/7 v_t, rolling.
        const double centre = slides ? v_t - mu * (1.0 + e) * v_n : 5.0 / 7.0 * v_t;
        const double spin = slides ? -2.5 * mu * (1.0 + e) * v_n / ball.radius : -centre / ball.radius;
        CAPTURE(degrees);
        CHECK(ball.centre(v_t, i.impulse) == Approx(centre).epsilon(1e-12));
        CHECK(ball.spin(0.0, i.impulse) == Approx(spin).epsilon(1e-12));
    }
}

TEST_CASE("test 6 of Chung and Ooi: a spinning sphere dropped on a plate") {
    const Sphere ball;
    const double mu = 0.4, e = 0.5, v_n = 0.2;
    for (const double spin : {-40.0, -1.0, 0.2, 3.0, 100.0}) {
        const double slip = ball.radius * std::abs(spin);
        const Impact i =
            uncoupled_impact(ball.k_t(), 1.0 / ball.mass, ball.velocity(0.0, v_n, spin), {mu, e});
        const double gained = std::min(mu * (1.0 + e) * v_n, 2.0 / 7.0 * slip); // of tangential speed
        CHECK(ball.centre(0.0, i.impulse) == Approx(-std::copysign(gained, spin)).epsilon(1e-12));
        CHECK(i.velocity.z() == Approx(e * v_n).epsilon(1e-12));
    }
}

TEST_CASE("tests 7 and 8 of Chung and Ooi: two spheres, equal and unequal") {
    const double mu = 0.3, e = 0.7;
    for (const double ratio : {1.0, 5.0})
        for (const double v_t : {0.1, 0.9, 8.0}) {
            const double m1 = 1.0, m2 = ratio * ratio * ratio, reduced = m1 * m2 / (m1 + m2);
            const Impact i = uncoupled_impact(3.5 / reduced, 1.0 / reduced, {v_t, 0.0, -1.0}, {mu, e});
            const double p = (1.0 + e) * reduced, t = std::min(mu * p, 2.0 / 7.0 * reduced * v_t);
            check_impulse(i, {-t, 0.0, p});
        }
}

// --- What holds for every impact: no NaN, energy, friction cone, separation, bounded work, no dependence on
// scale.

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

TEST_CASE("impacts side by side have the bits that each has alone") {
    RandomStream random(7);
    std::vector<Impact> together;
    for (int k = 0; k < 4000;) {
        std::vector<ImpactCase> cases;
        for (int count = 1 + k % 11; count > 0; --count)
            cases.push_back(any_case(random, k++));
        stronge_impacts(cases, together);
        REQUIRE(together.size() == cases.size());
        for (std::size_t i = 0; i < cases.size(); ++i) {
            const Impact alone = stronge_impact(cases[i].inverse_mass, cases[i].velocity, cases[i].surface);
            CHECK(together[i].impulse == alone.impulse);
            CHECK(together[i].velocity == alone.velocity);
        }
    }
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
