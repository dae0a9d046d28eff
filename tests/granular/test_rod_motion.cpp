// Free and held rods between impacts, against an integration of Euler's equations.

#include "beds.hpp"
#include "store/scratch.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/granular/shape.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

using namespace rodwake;
using namespace rodwake::granular;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using granular::Clump;
using granular::RodKind;
using granular::RodShape;
using granular::Taper;

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

// --- Mass properties of rods, against closed forms and against plain numerical integration of the outline

namespace {

struct Sums {
    long double area = 0, volume = 0, x = 0, x2 = 0, r4 = 0;
};

/// Which sphere is outermost at x, and the square of the outline's radius there.
std::pair<std::size_t, double> outermost(const Clump& clump, double x) {
    std::pair<std::size_t, double> best{0, -1e9};
    for (std::size_t k = 0; k < clump.offset.size(); ++k) {
        const double t = x - clump.offset[k], square = clump.radius[k] * clump.radius[k] - t * t;
        if (square > best.second)
            best = {k, square};
    }
    return best;
}

/// Three-point Gauss slices, halved until both ends are on one sphere: exact for polynomials up to degree 5.
void add_slice(const Clump& clump, double low, double high, Sums& sums, int depth = 0) {
    const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
    if (depth < 40 && outermost(clump, low).first != outermost(clump, high).first) {
        add_slice(clump, low, middle, sums, depth + 1);
        add_slice(clump, middle, high, sums, depth + 1);
        return;
    }
    for (const auto& [node, weight] :
         {std::pair{-std::sqrt(0.6), 5.0 / 9.0}, {0.0, 8.0 / 9.0}, {std::sqrt(0.6), 5.0 / 9.0}}) {
        const double x = middle + half * node, w = half * weight, square = outermost(clump, x).second;
        sums.area += 2.0 * std::sqrt(std::max(square, 0.0)) * w;
        sums.volume += M_PI * square * w;
        sums.x += M_PI * square * x * w;
        sums.x2 += M_PI * square * x * x * w;
        sums.r4 += M_PI * square * square * w;
    }
}

Sums sum_of_slices(const Clump& clump) {
    double low = 1e9, high = -1e9;
    for (std::size_t k = 0; k < clump.offset.size(); ++k) {
        low = std::min(low, clump.offset[k] - clump.radius[k]);
        high = std::max(high, clump.offset[k] + clump.radius[k]);
    }
    Sums sums;
    const int slices = 20'000;
    const double width = (high - low) / slices;
    for (int i = 0; i < slices; ++i)
        add_slice(clump, low + i * width, low + (i + 1) * width, sums);
    return sums;
}

RodShape apolar(Taper taper, std::size_t spheres) {
    RodShape shape;
    shape.kind = RodKind::apolar;
    shape.taper = taper;
    shape.spheres = spheres;
    return shape;
}

/// Largest relative error of the closed forms against slices.
double error_of(const Clump& clump, const RodShape& shape) {
    const Sums s = sum_of_slices(clump);
    const double density = shape.density, length = shape.length;
    const auto relative = [](double found, long double wanted) {
        return std::abs(found / static_cast<double>(wanted) - 1.0);
    };
    return std::max({relative(clump.mass, density * s.volume),
                     relative(clump.axial_inertia, density * 0.5L * s.r4),
                     relative(clump.transverse_inertia, density * (0.25L * s.r4 + s.x2)),
                     static_cast<double>(std::abs(s.x / (s.volume * length)))});
}

void refuses(const RodShape& shape, const std::string& word) {
    CHECK_THAT(store_test::error_of<InputError>([&] { make_clump(shape); }), Catch::Contains(word));
}

} // namespace

TEST_CASE("the default rod has the mass and inertia of the paper's rod") {
    const Clump rod = granular::make_clump({});
    CHECK(rod.mass == Approx(24.9e-6).margin(0.05e-6)); // physics page: three digits
    CHECK(rod.transverse_inertia == Approx(36.9e-12).margin(0.05e-12));
    CHECK(rod.axial_inertia == Approx(2.79e-12).margin(0.005e-12));
    CHECK(rod.radius.front() == 0.55e-3);
    CHECK(rod.radius.back() == 0.40e-3);
    CHECK(rod.offset.back() + rod.radius.back() - (rod.offset.front() - rod.radius.front()) ==
          Approx(4.5e-3).epsilon(1e-14)); // rounding of four numbers
    CHECK(rod.reach() == rod.offset.back() + rod.radius.back());
    CHECK(std::abs(rod.offset.front()) + rod.radius.front() < rod.reach()); // the heavy end is nearer
}

TEST_CASE("closed forms agree with slices for every kind of rod") {
    RodShape stepwise;
    stepwise.taper = Taper::stepwise;
    RodShape crowded; // steep and dense: some spheres are hidden inside others
    crowded.length = 1.6e-3;
    crowded.spheres = 200;
    crowded.thin_diameter = 0.7e-3;
    RodShape even;
    even.thin_diameter = even.thick_diameter;
    for (const RodShape& shape :
         {RodShape{}, stepwise, crowded, even, apolar(Taper::linear, 13), apolar(Taper::stepwise, 15)}) {
        const Clump rod = granular::make_clump(shape);
        CHECK(error_of(rod, shape) < 1e-12); // slices are exact up to the rounding of 20 000 terms
        const double shadow = static_cast<double>(sum_of_slices(rod).area);
        CHECK(rod.projected_area() ==
              Approx(shadow).epsilon(1e-6)); // slices: the square root at the ends, (1/20 000)^1.5
    }
}

TEST_CASE("the comparison with slices sees a wrong inertia and a wrong origin") {
    const RodShape shape;
    Clump rod = granular::make_clump(shape);
    rod.transverse_inertia *= 1.0 + 1e-10;
    CHECK(error_of(rod, shape) > 1e-11);
    rod = granular::make_clump(shape);
    for (double& x : rod.offset)
        x += 1e-9;
    CHECK(error_of(rod, shape) > 1e-8);
}

TEST_CASE("one sphere is a solid sphere") {
    RodShape shape;
    shape.spheres = 1;
    shape.length = shape.thick_diameter = shape.thin_diameter = 1e-3;
    for (const RodKind kind : {RodKind::motile, RodKind::apolar}) {
        shape.kind = kind;
        const Clump ball = granular::make_clump(shape);
        const double r = 0.5e-3, mass = 8500.0 * 4.0 / 3.0 * M_PI * r * r * r;
        CHECK(ball.mass == Approx(mass).epsilon(1e-14)); // rounding
        CHECK(ball.axial_inertia == Approx(0.4 * mass * r * r).epsilon(1e-14));
        CHECK(ball.transverse_inertia == Approx(0.4 * mass * r * r).epsilon(1e-14));
        CHECK(ball.projected_area() == Approx(M_PI * r * r).epsilon(1e-14));
        CHECK(ball.reach() == Approx(r).epsilon(1e-14));
    }
}

TEST_CASE("two equal spheres are a peanut with known volume") {
    RodShape shape;
    shape.spheres = 2;
    shape.thick_diameter = shape.thin_diameter = 2e-3;
    shape.length = 3e-3; // centres one radius apart: two spheres less a lens 5 pi r^3/12
    const Clump rod = granular::make_clump(shape);
    CHECK(rod.mass == Approx(8500.0 * M_PI * 1e-9 * (8.0 / 3.0 - 5.0 / 12.0)).epsilon(1e-14));
}

TEST_CASE("an apolar rod is symmetric to the bit") {
    for (const Taper taper : {Taper::linear, Taper::stepwise}) {
        const Clump rod = granular::make_clump(apolar(taper, 13));
        for (std::size_t k = 0; k < 13; ++k) {
            CHECK(rod.offset[k] == -rod.offset[12 - k]);
            CHECK(rod.radius[k] == rod.radius[12 - k]);
        }
        CHECK(rod.radius[6] == 0.55e-3);
        CHECK(rod.radius[0] == 0.40e-3);
    }
}

TEST_CASE("a stepwise taper has equal pieces with evenly falling radii") {
    RodShape shape;
    shape.taper = Taper::stepwise;
    const Clump rod = granular::make_clump(shape);
    for (std::size_t k = 0; k < 12; ++k)
        CHECK(rod.radius[k] == Approx(0.55e-3 - 0.05e-3 * static_cast<double>(k / 3)).epsilon(1e-14));
}

TEST_CASE("what is no rod is refused with a reason") {
    const auto with = [](auto change) {
        RodShape shape;
        change(shape);
        return shape;
    };
    refuses(with([](auto& s) { s.length = -1.0; }), "length = -1");
    refuses(with([](auto& s) { s.length = std::nan(""); }), "length");
    refuses(with([](auto& s) { s.thin_diameter = 0.0; }), "thin_diameter");
    refuses(with([](auto& s) { s.density = std::numeric_limits<double>::infinity(); }), "density");
    refuses(with([](auto& s) { s.spheres = 0; }), "spheres = 0");
    refuses(with([](auto& s) { s.spheres = 1; }), "one sphere");
    refuses(with([](auto& s) { s.thin_diameter = 1.2e-3; }), "at most thick_diameter");
    refuses(with([](auto& s) { s.length = 1.0e-3; }), "at least thick_diameter");
    refuses(with([](auto& s) { s.kind = RodKind::apolar; }), "odd");
    refuses(with([](auto& s) { s.spheres = 3; }), "apart"); // far apart: 1.775 mm > 1.025 mm
    refuses(with([](auto& s) { s.taper = Taper::stepwise, s.segments = 13; }), "segments = 13");
    refuses(with([](auto& s) { s.taper = Taper::stepwise, s.segments = 1; }), "segments = 1");
    refuses(
        with([](auto& s) { s.length = 1.12e-3, s.spheres = 40, s.taper = Taper::stepwise, s.segments = 4; }),
        "sticks out");
    CHECK_NOTHROW(make_clump({}));
}

TEST_CASE("all mistakes of a shape are named at once") {
    RodShape shape;
    shape.length = -1.0;
    shape.density = 0.0;
    CHECK_THAT(store_test::error_of<InputError>([&] { make_clump(shape); }),
               Catch::Contains("length") && Catch::Contains("density"));
}
