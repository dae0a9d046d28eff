// Fixed points of a pair's flow, against the equations of motion in the lab, other codes, and random starts.

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/rods/pair_branches.hpp"
#include "rodwake/rods/settled_orbit.hpp"
#include "rodwake/rods/simulate.hpp"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>

using namespace rodwake;

namespace {

constexpr double pi = std::numbers::pi;

struct System {
    elastic::Medium medium;
    rods::Couplings couplings;
};

System random_system(RandomStream& random, bool polar) {
    const double xi = random.log_uniform(0.1, 10.0);
    const auto gamma = [&] { return polar ? random.uniform(-60.0, 60.0) * xi : 0.0; };
    return {{random.log_uniform(0.1, 10.0), xi}, {random.uniform(-120.0, 120.0), gamma(), gamma()}};
}

/// Rates of rod 1's pose in the frame of rod 0, from the equations of motion in the lab, with rod 0 anywhere.
Eigen::Vector3d lab_rates(const System& s, const rods::Pose& q) {
    const rods::Pose rod0{0.3, -0.2, 0.7};
    const double c = std::cos(rod0.heading), sn = std::sin(rod0.heading);
    const std::vector<double> y{rod0.x,
                                rod0.y,
                                rod0.heading,
                                rod0.x + c * q.x - sn * q.y,
                                rod0.y + sn * q.x + c * q.y,
                                rod0.heading + q.heading};
    std::vector<double> ydot(6);
    rods::RodModel(elastic::exact_field(s.medium), s.couplings, 2).rhs(y, ydot);
    const double vx = ydot[3] - ydot[0], vy = ydot[4] - ydot[1];
    return {c * vx + sn * vy + ydot[2] * q.y, c * vy - sn * vx - ydot[2] * q.x, ydot[5] - ydot[2]};
}

/// Their derivatives by differences of fourth order.
Eigen::Matrix3d lab_jacobian(const System& s, const rods::Pose& q) {
    Eigen::Matrix3d jacobian;
    const double r = std::hypot(q.x, q.y);
    for (Eigen::Index j = 0; j < 3; ++j) {
        const double h = 2e-3 * (j < 2 ? r : 1.0);
        const auto at = [&](double steps) {
            rods::Pose p = q;
            (j == 0 ? p.x : j == 1 ? p.y : p.heading) += steps * h;
            return lab_rates(s, p);
        };
        jacobian.col(j) = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * h);
    }
    return jacobian;
}

std::vector<rods::PairEquilibrium> found_as(const System& s, rods::EquilibriumKind kind) {
    auto found = rods::pair_equilibria(s.medium, s.couplings);
    std::erase_if(found, [&](const auto& e) { return e.kind != kind; });
    return found;
}
constexpr auto orbit = rods::EquilibriumKind::orbit;
constexpr auto in_line = rods::EquilibriumKind::in_line;

} // namespace

TEST_CASE("a pair's flow and its Jacobian are those of the equations of motion in the lab") {
    RandomStream random(5);
    for (int k = 0; k < 60; ++k) {
        const System s = random_system(random, k % 2 == 1);
        const double r = s.medium.xi * random.log_uniform(0.1, 5.0), angle = random.uniform(-pi, pi);
        const rods::Pose q{r * std::cos(angle), r * std::sin(angle), random.uniform(-pi, pi)};
        const rods::PairFlow flow = rods::pair_flow(s.medium, s.couplings, q);
        const Eigen::Matrix3d by_pose = lab_jacobian(s, q);
        const double scale = 1.0 + flow.by_pose.norm();
        CHECK((flow.rates - lab_rates(s, q)).norm() < 1e-12 * scale * (1.0 + r));
        // truncation (2e-3)^4/5 of a fifth derivative, rounding 1e-13/2e-3
        CHECK((flow.by_pose - by_pose).norm() < 1e-8 * scale * std::max(r, 1.0 / r));
    }
}

TEST_CASE("orbits that two other programs found") {
    // separation, omega and eigenvalues to the digits given
    struct Known {
        System system;
        rods::Pose pose;
        double omega;
        std::complex<double> eigenvalues[3];
        double to;
    };
    const Known wide{{{1.0, 1.0}, {.kappa = 26.05842651829}},
                     {-1.97850743, 1.36092121, -1.20505329},
                     0.47200140,
                     {0.17642976, {-0.60881, 0.17500}, {-0.60881, -0.17500}},
                     1e-5};
    const Known tight{{{1.0, 1.0 / 0.3}, {.kappa = 23.0}},
                      {-1.72806389, 1.56732073, -1.47331705},
                      0.57593510,
                      {-0.027, -0.271, -0.529},
                      5e-4};
    for (const Known& known : {wide, tight}) {
        const auto orbits = found_as(known.system, orbit);
        REQUIRE_FALSE(orbits.empty());
        const auto& e = orbits.front();
        CHECK(e.pose.x == Approx(known.pose.x).margin(6e-9));
        CHECK(e.pose.y == Approx(known.pose.y).margin(6e-9));
        CHECK(e.pose.heading == Approx(known.pose.heading).margin(6e-9));
        CHECK(e.omega == Approx(known.omega).margin(6e-9));
        for (const int k : {0, 1, 2})
            CHECK(std::abs(e.eigenvalues[k] - known.eigenvalues[k]) < 1.5 * known.to);
        CHECK(e.stable() == (known.eigenvalues[0].real() < 0.0));
    }
    const auto separation = [&](double kappa) {
        return found_as({{1.0, 1.0 / 0.3}, {.kappa = kappa}}, orbit).front().separation[0];
    };
    CHECK(separation(24.0) == Approx(0.26688).margin(5e-6));
    CHECK(separation(24.2495989) == Approx(0.1).margin(3e-8)); // d r/d kappa = -0.4: 5e-8 of kappa
}

TEST_CASE("fixed points are fixed, in the lab too, and their eigenvalues those of its differences") {
    RandomStream random(6);
    int orbits = 0;
    for (int k = 0; k < 24; ++k) {
        const System s = random_system(random, k % 2 == 1);
        for (const auto& e : rods::pair_equilibria(s.medium, s.couplings)) {
            if (e.separation[0] < 0.02 * s.medium.xi)
                continue; // where differences say little
            CHECK(lab_rates(s, e.pose).norm() <
                  1e-10 * (1.0 + rods::pair_flow(s.medium, s.couplings, e.pose).by_pose.norm()));
            Eigen::Vector3cd values = lab_jacobian(s, e.pose).eigenvalues();
            for (const auto& value : e.eigenvalues)
                CHECK((values.array() - value).abs().minCoeff() <
                      1e-5 * (1.0 + std::abs(e.eigenvalues[0])) / std::min(1.0, e.separation[0]));
            if (e.kind == in_line)
                continue;
            ++orbits;
            CHECK(e.omega >= 0.0);
            CHECK(e.pose.x <= 1e-12);
            CHECK(e.pose.y > 0.0);
            CHECK(e.pose.heading <= 0.0);
        }
    }
    CHECK(orbits > 10);
}

TEST_CASE("Newton's method from random starts finds no other orbit") {
    RandomStream random(7);
    int hits = 0;
    for (int k = 0; k < 20; ++k) {
        System s = random_system(random, k % 2 == 1);
        if (k < 4)
            s = {{1.0, 1.0}, {.kappa = 22.5 + 0.5 * k}}; // about the fold
        const auto known = rods::pair_equilibria(s.medium, s.couplings);
        for (int start = 0; start < 150; ++start) {
            const double r = s.medium.xi * random.log_uniform(2e-3, 20.0), angle = random.uniform(-pi, pi);
            const auto e = rods::equilibrium_near(
                s.medium, s.couplings, {r * std::cos(angle), r * std::sin(angle), random.uniform(-pi, pi)});
            if (!e || e->separation[0] < rods::least_searched * s.medium.xi ||
                e->separation[0] > rods::most_searched * s.medium.xi)
                continue;
            ++hits;
            const bool listed = std::ranges::any_of(known, [&](const auto& other) {
                return other.kind == e->kind &&
                       std::abs(other.separation[0] / e->separation[0] - 1.0) < 1e-6 &&
                       std::abs(std::abs(e->omega) - other.omega) < 1e-6 * (1.0 / s.medium.xi + other.omega);
            });
            CAPTURE(k, s.medium.eta, s.medium.xi, s.couplings.kappa, s.couplings.gamma1, s.couplings.gamma2,
                    e->pose.x, e->pose.y, e->pose.heading);
            CHECK(listed);
        }
    }
    CHECK(hits > 200);
}

TEST_CASE("rods that start in a stable orbit, tight or wide, go round in it") {
    for (const System& s :
         {System{{1.0, 1.0 / 0.3}, {.kappa = 23.0}}, System{{10.0, 1.0}, {.kappa = 130.0}}}) {
        const auto orbits = found_as(s, orbit);
        const auto stable = std::ranges::find_if(orbits, [](const auto& e) { return e.stable(); });
        REQUIRE(stable != orbits.end());
        const double period = 2.0 * pi / stable->omega;
        const rods::RodProblem problem{s.medium,     s.couplings, {{0, 0, 0}, stable->pose},
                                       2.0 * period, {},          {}};
        rods::RodOptions options;
        options.ode.method = integrate::Method::erk;
        options.ode.rtol = 1e-11;
        options.ode.atol = 1e-12;
        const auto end = rods::simulate(problem, options).solution.final_state;
        CHECK(end[2] == Approx(4.0 * pi).margin(1e-7)); // rod 0, where it began
        CHECK(std::hypot(end[0], end[1]) < 1e-7);
        CHECK(std::hypot(end[3] - end[0], end[4] - end[1]) == Approx(stable->separation[0]).epsilon(1e-8));
    }
}

TEST_CASE("in line: eigenvalues at a distance, and intervals of equal stability") {
    const auto largest = [](double kappa, double distance) {
        return rods::in_line_eigenvalues({1.0, 1.0}, {.kappa = kappa}, distance)[0];
    };
    CHECK(largest(10, 1).real() == Approx(0.23).margin(0.005)); // by another program
    CHECK(largest(10, 2).real() == Approx(0.040).margin(0.0005));
    CHECK(largest(26, 2).real() == Approx(0.95).margin(0.005));
    CHECK(largest(26, 2.5).real() == Approx(0.45).margin(0.005));
    CHECK(largest(100, 3).real() == Approx(2.4).margin(0.05));
    CHECK(largest(100, 5).real() == Approx(0.40).margin(0.005));
    CHECK(largest(10, 2).imag() > 0.1); // weaving
    CHECK(largest(26, 2).imag() == 0.0);
    for (const double kappa : {10.0, 26.0, 100.0, -60.0}) {
        const auto intervals = found_as({{1.0, 1.0}, {.kappa = kappa}}, in_line);
        CHECK(intervals.front().separation[0] == Approx(1e-3));
        CHECK(intervals.back().separation[1] == Approx(30.0));
        for (std::size_t k = 0; k + 1 < intervals.size(); ++k) {
            const double end = intervals[k].separation[1];
            CHECK(intervals[k + 1].separation[0] == end);
            CHECK(intervals[k + 1].stable() != intervals[k].stable());
            CHECK(std::abs(largest(kappa, end).real()) < 1e-10);
        }
    }
    CHECK(found_as({{1.0, 1.0}, {}}, in_line).size() == 1);
    CHECK(found_as({{1.0, 1.0}, {}}, orbit).empty());
}

TEST_CASE("lengths and times times alpha remove alpha, with polar couplings times alpha too") {
    const System one{{2.0, 1.0}, {30.0, 5.0, -3.0}}, other{{2.0, 7.0}, {30.0, 35.0, -21.0}};
    const auto a = rods::pair_equilibria(one.medium, one.couplings);
    const auto b = rods::pair_equilibria(other.medium, other.couplings);
    REQUIRE(a.size() == b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
        CHECK(7.0 * a[k].separation[1] == Approx(b[k].separation[1]).epsilon(1e-12));
        CHECK(a[k].omega == Approx(7.0 * b[k].omega).epsilon(1e-12).margin(1e-14));
    }
}

TEST_CASE("branches over kappa end in the fold, and hold what is found at each kappa") {
    const auto branches = rods::pair_branches({1.0, 1.0}, {}, rods::BranchParameter::kappa, 20.0, 30.0);
    REQUIRE(branches.size() == 1);
    const auto& points = branches.front().points;
    std::vector<rods::BranchPoint> folds;
    std::ranges::copy_if(points, std::back_inserter(folds), &rods::BranchPoint::fold);
    REQUIRE(folds.size() == 1);
    const double fold = folds.front().parameter;
    CHECK(fold == Approx(22.940713).margin(5e-7)); // another program
    CHECK(folds.front().equilibrium.separation[0] == Approx(0.925).margin(5e-4));
    CHECK(std::abs(folds.front().equilibrium.eigenvalues[0]) < 1e-6);
    CHECK(found_as({{1.0, 1.0}, {.kappa = fold - 1e-9}}, orbit).empty()); // the fold to 1e-9
    CHECK(found_as({{1.0, 1.0}, {.kappa = fold + 1e-9}}, orbit).size() == 2);
    for (const auto& point : points) {
        const System s{{1.0, 1.0}, {.kappa = point.parameter}};
        CHECK(lab_rates(s, point.equilibrium.pose).norm() <
              1e-12 * (1.0 + rods::pair_flow(s.medium, s.couplings, point.equilibrium.pose).by_pose.norm()));
    }
}

TEST_CASE("branches over eta, alpha and polar couplings agree with fixed points along them") {
    const rods::Couplings couplings{28.0, 4.0, -2.0};
    using P = rods::BranchParameter;
    for (const auto& [over, least, most] :
         {std::tuple{P::eta, 0.2, 8.0}, std::tuple{P::alpha, 0.5, 4.0}, std::tuple{P::gamma1, -10.0, 10.0},
          std::tuple{P::gamma2, -10.0, 10.0}}) {
        const auto branches = rods::pair_branches({1.0, 1.0}, couplings, over, least, most);
        REQUIRE_FALSE(branches.empty());
        for (const auto& branch : branches) {
            CHECK(branch.first_end != "lost");
            CHECK(branch.last_end != "lost");
            for (std::size_t k = 0; k < branch.points.size(); k += 7) {
                const auto& [p, e, is_fold] = branch.points[k];
                System s{{1.0, 1.0}, couplings};
                (over == P::eta      ? s.medium.eta
                 : over == P::alpha  ? s.medium.xi
                 : over == P::gamma1 ? s.couplings.gamma1
                                     : s.couplings.gamma2) = over == P::alpha ? 1.0 / p : p;
                CHECK(lab_rates(s, e.pose).norm() <
                      1e-11 * (1.0 + rods::pair_flow(s.medium, s.couplings, e.pose).by_pose.norm()));
            }
        }
    }
}

TEST_CASE("rods on their way into a stable orbit are reported, others are not") {
    const System s{{1.0, 1.0 / 0.3}, {.kappa = 23.0}};
    const auto e = found_as(s, orbit).front();
    const auto approach = [&](double off, std::optional<double> contact = {}) {
        // in the lab, and mirrored: rod 1 goes the other way round
        return rods::settled_orbit(s.medium, s.couplings, {5.0, 6.0, 0.0},
                                   {5.0 + e.pose.x + off, 6.0 - e.pose.y, -e.pose.heading}, contact);
    };
    REQUIRE(approach(0.01));
    CHECK(approach(0.01)->orbit.separation[0] == Approx(e.separation[0]).epsilon(1e-9));
    CHECK(approach(0.01)->orbit.omega == Approx(-e.omega).epsilon(1e-9));
    CHECK(approach(0.01)->decay == Approx(-e.eigenvalues[0].real()));
    CHECK(approach(0.01)->distance == Approx(0.01 / e.separation[0]).epsilon(1e-6));
    CHECK(approach(0.0));
    CHECK_FALSE(approach(0.01, 2.4)); // in contact there
    CHECK_FALSE(approach(3.0));
    const auto wide = found_as(s, orbit).back();
    REQUIRE_FALSE(wide.stable());
    CHECK_FALSE(rods::settled_orbit(s.medium, s.couplings, {}, wide.pose));

    // The prediction holds: after 60 more periods the pair is in the orbit that was predicted.
    rods::RodOptions options;
    options.ode.rtol = 1e-10;
    options.ode.atol = 1e-11;
    const rods::Pose start{e.pose.x + 0.02, e.pose.y, e.pose.heading - 0.01};
    REQUIRE(rods::settled_orbit(s.medium, s.couplings, {}, start));
    const auto end =
        rods::simulate({s.medium, s.couplings, {{}, start}, 600.0, {}, {}}, options).solution.final_state;
    CHECK(std::hypot(end[3] - end[0], end[4] - end[1]) ==
          Approx(e.separation[0]).epsilon(1e-7)); // exp(-0.027 600)
}

TEST_CASE(
    "rounding far beside a rod is no fixed point, and branches stay within the domain of eta and alpha") {
    for (const double kappa : {-1.0, 30.0})
        for (const double eta : {-0.9, -0.99})
            CHECK(found_as({{eta, 1.0}, {.kappa = kappa}}, rods::EquilibriumKind::parallel).empty());
    CHECK(found_as({{-0.99, 1.0}, {.kappa = -1.0}}, orbit).size() == 1);
    using P = rods::BranchParameter;
    for (const auto& [over, least, most] :
         {std::tuple{P::eta, -0.9, 50.0}, std::tuple{P::alpha, 0.01, 100.0}}) {
        const auto branches = rods::pair_branches({1.0, 1.0}, {.kappa = 30.0}, over, least, most);
        REQUIRE_FALSE(branches.empty());
        for (const auto& branch : branches)
            CHECK((branch.first_end != "lost" && branch.last_end != "lost"));
    }
}

TEST_CASE("pairs that cannot be looked at are refused") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_AS(rods::pair_equilibria({-1.0, 1.0}, {.kappa = 1.0}), InputError);
    CHECK_THROWS_AS(rods::pair_equilibria({1.0, 1.0}, {.kappa = nan}), InputError);
    CHECK_THROWS_AS(rods::pair_flow({1.0, 1.0}, {.kappa = 1.0}, {}), InputError);
    CHECK_THROWS_AS(rods::branch_parameter("xi"), InputError);
    using P = rods::BranchParameter;
    CHECK_THROWS_AS(rods::pair_branches({}, {}, P::kappa, 2.0, 1.0), InputError);
    CHECK_THROWS_AS(rods::pair_branches({}, {}, P::alpha, 0.0, 1.0), InputError);
    CHECK_THROWS_AS(rods::pair_branches({}, {}, P::eta, -1.0, 1.0), InputError);
}
