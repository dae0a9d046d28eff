// Free and held rods between impacts, against an integration of Euler's equations.

#include "beds.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

const double g = GranularProblem{}.gravity;

RodBody thrown(RandomStream& random, const Clump& clump) {
    RodBody body;
    body.position = beds::random_vector(random, 1e-3);
    body.velocity = beds::random_vector(random, 0.3);
    body.orientation = beds::random_turn(random);
    const Vector3d inertia(clump.axial_inertia, clump.transverse_inertia, clump.transverse_inertia);
    body.angular_momentum =
        body.orientation * Vector3d(inertia.cwiseProduct(beds::random_vector(random, 300.0)));
    return body;
}

/// Quaternion and body angular velocity.
struct Top {
    Quaterniond q;
    Vector3d w;
};

Top slope(const Top& s, const Vector3d& inertia) {
    const Quaterniond rate = s.q * Quaterniond(0.0, s.w.x(), s.w.y(), s.w.z());
    const Vector3d Iw = inertia.cwiseProduct(s.w);
    return {Quaterniond(0.5 * rate.coeffs()), (-s.w.cross(Iw)).cwiseQuotient(inertia)};
}

Top plus(const Top& s, double h, const Top& d) {
    return {Quaterniond(Eigen::Vector4d(s.q.coeffs() + h * d.q.coeffs())), s.w + h * d.w};
}

/// Euler's equations by classical Runge-Kutta.
Top integrate(Top s, const Vector3d& inertia, double time, int steps) {
    const double h = time / steps;
    for (int n = 0; n < steps; ++n) {
        const Top k1 = slope(s, inertia), k2 = slope(plus(s, h / 2, k1), inertia),
                  k3 = slope(plus(s, h / 2, k2), inertia), k4 = slope(plus(s, h, k3), inertia);
        s = plus(plus(plus(plus(s, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
    }
    return s;
}

double distance(const Quaterniond& a, const Quaterniond& b) {
    return (a.toRotationMatrix() - b.toRotationMatrix()).norm();
}

} // namespace

TEST_CASE("a free rod turns as Euler's equations say") {
    RandomStream random(11);
    for (int n = 0; n < 5; ++n) {
        const RodSpec spec = beds::long_rod(0.0, 0.0, 0.0);
        const Clump clump = make_clump(spec.shape);
        const RodBody start = thrown(random, clump);
        const Vector3d inertia(clump.axial_inertia, clump.transverse_inertia, clump.transverse_inertia);
        const Top top{start.orientation,
                      (start.orientation.conjugate() * start.angular_momentum).cwiseQuotient(inertia)};
        const double time = 0.02; // about a turn
        MovingRod rod(spec, start);
        for (int k = 0; k < 1000; ++k)
            rod.move(time / 1000, g);
        const Top wanted = integrate(top, inertia, time, 20000);
        // Runge-Kutta: (300/s * 1e-6 s)^4 = 1e-14 a turn; rounding of 1000 products
        CHECK(distance(rod.body().orientation, wanted.q) < 1e-10);
        CHECK(distance(integrate(top, inertia, 0.999 * time, 20000).q, wanted.q) >
              1e-4); // the check can fail
        CHECK(std::abs(rod.body().orientation.norm() - 1.0) < 4e-16);
        CHECK(rod.body().angular_momentum == start.angular_momentum);
        const Vector3d place =
            start.position + time * start.velocity - Vector3d(0.0, 0.0, g * time * time / 2.0);
        CHECK((rod.body().position - place).norm() < 1e-15 * 10.0); // rounding of 1000 sums of size 1e-2
        CHECK(rod.energy(g) == Approx(MovingRod(spec, start).energy(g)).epsilon(1e-12));
    }
}

TEST_CASE("one long flight equals many short ones") {
    RandomStream random(12);
    const RodSpec spec = beds::long_rod(0.0, 0.0, 0.0);
    const RodBody start = thrown(random, make_clump(spec.shape));
    MovingRod once(spec, start), often(spec, start);
    once.move(0.05, g);
    for (int k = 0; k < 100; ++k)
        often.move(0.0005, g);
    CHECK(distance(once.body().orientation, often.body().orientation) <
          1e-12); // rounding of angles of about 15 rad
}

TEST_CASE("velocity and inverse mass at a point are those of the moving material") {
    RandomStream random(13);
    const RodSpec spec = beds::long_rod(0.0, 0.0, 0.0);
    MovingRod rod(spec, thrown(random, make_clump(spec.shape)));
    const Vector3d arm = beds::random_vector(random, 2e-3), impulse = beds::random_vector(random, 1e-6);
    const Vector3d before = rod.velocity_at(arm), change = rod.inverse_mass_at(arm) * impulse;
    MovingRod pushed = rod;
    pushed.push(impulse, arm);
    CHECK((pushed.velocity_at(arm) - before - change).norm() < 1e-13 * change.norm());
    // of a material point: finite difference of its place, error h^2 w^3 r
    const Vector3d in_body = rod.body().orientation.conjugate() * arm;
    const double h = 1e-6;
    MovingRod later = rod, earlier = rod;
    later.move(h, 0.0);
    earlier.move(-h, 0.0);
    const auto place = [&](const MovingRod& r) {
        return Vector3d(r.body().position + r.body().orientation * in_body);
    };
    CHECK(((place(later) - place(earlier)) / (2.0 * h) - before).norm() < 1e-6);
}

TEST_CASE("a held rod keeps its course, its pitch rate and its roll rate") {
    RodSpec spec = beds::long_rod(0.0, 0.0, 0.7);
    spec.imposed_speed = 1e-3;
    RodBody body;
    body.orientation = Quaterniond(Eigen::AngleAxisd(0.7, Vector3d::UnitZ()));
    MovingRod rod(spec, body);
    rod.hold(spec.imposed_speed);
    rod.push({3e-6, -2e-6, 1e-6}, {1e-3, 1e-3, -4e-4});
    const Vector3d across(-std::sin(0.7), std::cos(0.7), 0.0);
    CHECK(rod.body().velocity.head<2>() == Eigen::Vector2d(1e-3 * rod.ahead()));
    CHECK(rod.body().velocity.z() != 0.0);
    const double energy = rod.energy(0.0);
    CHECK(energy > 0.5 * rod.clump().mass * 1e-6); // it pitches and rolls
    double heading_error = 0.0;
    for (int k = 0; k < 100000; ++k) {
        rod.move(2e-5, 0.0);
        const Vector3d axis = rod.axis();
        heading_error = std::max(heading_error, std::abs(axis.dot(across)));
    }
    CHECK(rod.body().velocity.head<2>() == Eigen::Vector2d(1e-3 * rod.ahead()));
    CHECK(heading_error < 1e-12); // rounding of 1e5 products: a random walk of 300 ulp
    MovingRod again = rod;
    again.hold(spec.imposed_speed); // holding again changes no bit
    CHECK(again.body().velocity == rod.body().velocity);
    CHECK(again.body().angular_momentum == rod.body().angular_momentum);
    CHECK(
        rod.energy(0.0) ==
        Approx(energy).epsilon(5e-8)); // measured 8e-9 in 1e5 steps: rounding tilts the axis out of its plane
}

TEST_CASE("a rod that is let go moves on freely") {
    RodSpec spec = beds::long_rod(0.0, 0.0, 0.0);
    MovingRod rod(spec, RodBody{});
    rod.hold(0.0);
    rod.push({1e-6, 1e-6, 1e-6}, {1e-3, 0.0, 0.0});
    CHECK(rod.body().velocity.head<2>() == Eigen::Vector2d::Zero());
    CHECK(rod.body().angular_momentum.z() == 0.0);
    rod.hold({});
    rod.push({1e-6, 1e-6, 1e-6}, {1e-3, 0.0, 0.0});
    CHECK(rod.body().velocity.x() == Approx(1e-6 / rod.clump().mass));
    CHECK(rod.body().angular_momentum.z() == Approx(1e-9));
}
