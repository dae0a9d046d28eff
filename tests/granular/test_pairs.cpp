// Impulses between beads and rods: momentum, energy, the first contact of a clump; and that no overlap is
// missed.

#include "beds.hpp"

#include "granular/pair_contacts.hpp"
#include "granular/pair_finder.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;

namespace {

const double a = GranularProblem{}.bead_radius;
constexpr double box = 0.05;
constexpr std::array still{0.0}; // m/s

/// Two beads and two rods, moving at random, far from each other.
struct Scene {
    GranularProblem problem;
    State state;
};

Scene random_scene(RandomStream& random, const Surface& surface) {
    Scene s;
    s.problem.beads = 2;
    s.problem.box = box;
    s.problem.rods = {beds::long_rod(0, 0, 0), beds::long_rod(0, 0, 0)};
    beds::set_contacts(s.problem, surface);
    s.state.beads.resize(2);
    s.state.rods.resize(2);
    for (int i = 0; i < 2; ++i) {
        s.state.beads.x[i] = 0.02 * i;
        s.state.beads.y[i] = 0.02;
        for (auto* v : {&s.state.beads.vx, &s.state.beads.vy, &s.state.beads.vz})
            (*v)[i] = random.uniform(-0.1, 0.1);
        for (auto* w : {&s.state.beads.wx, &s.state.beads.wy, &s.state.beads.wz})
            (*w)[i] = random.uniform(-200.0, 200.0);
        RodBody& rod = s.state.rods[i];
        const Clump clump = make_clump(s.problem.rods[i].shape);
        rod.position = {0.02 * i, 0.0, 0.0};
        rod.velocity = beds::random_vector(random, 0.1);
        rod.orientation = beds::random_turn(random);
        rod.angular_momentum = clump.transverse_inertia * beds::random_vector(random, 30.0);
    }
    return s;
}

Vector3 random_normal(RandomStream& random) { return beds::random_vector(random, 1.0).normalized(); }

enum class Kind { bead_bead, bead_rod, rod_rod };

/// Moves the second body of the pair so that the two spheres overlap a little along a random normal.
Pair bring_together(Scene& s, Kind kind, RandomStream& random) {
    const Bodies b = make_bodies(s.problem, s.state);
    const std::size_t spheres = b.rods[0].clump().radius.size();
    const auto pick = [&](std::size_t rod) {
        return static_cast<std::uint32_t>(
            2 + spheres * rod + static_cast<std::size_t>(random.uniform() * static_cast<double>(spheres)));
    };
    const Pair pair = kind == Kind::bead_bead  ? Pair{0, 1}
                      : kind == Kind::bead_rod ? Pair{0, pick(0)}
                                               : Pair{pick(0), pick(1)};
    const double distance =
        (b.radius[pair.first] + b.radius[pair.second]) * (1.0 - random.uniform(0.0, 0.02));
    const Vector3 move =
        row(b.position, pair.first) + distance * random_normal(random) - row(b.position, pair.second);
    if (kind == Kind::bead_bead) {
        s.state.beads.x[1] += move.x();
        s.state.beads.y[1] += move.y();
        s.state.beads.z[1] += move.z();
    } else {
        s.state.rods[kind == Kind::bead_rod ? 0 : 1].position += move;
    }
    return pair;
}

struct Motion {
    Vector3 momentum = Vector3::Zero(), angular = Vector3::Zero();
    double energy = 0.0, momentum_scale = 0.0, angular_scale = 0.0;
};

/// About `point`.
Motion motion(const Bodies& b, const Vector3& point) {
    Motion m;
    const auto add = [&](double mass, const Vector3& x, const Vector3& v, const Vector3& L) {
        m.momentum += mass * v;
        m.angular += mass * (x - point).cross(v) + L;
        m.momentum_scale += mass * v.norm();
        m.angular_scale += (mass * (x - point).cross(v)).norm() + L.norm();
    };
    for (std::size_t i = 0; i < b.beads; ++i)
        add(b.bead_mass, row(b.position, i), row(b.velocity, i), b.bead_inertia * row(b.spin, i));
    for (const MovingRod& rod : b.rods)
        add(rod.clump().mass, rod.body().position, rod.body().velocity, rod.body().angular_momentum);
    m.energy = total_energy(b, 0.0).kinetic;
    return m;
}

PairSetting setting(const GranularProblem& p) { return {p.contacts, p.box, p.time_step, 0.0}; }

struct Outcome {
    Motion before, after;
    Counters tallies;
};

Outcome collide(const Scene& s, const std::vector<Pair>& pairs) {
    Bodies b = make_bodies(s.problem, s.state);
    PairContacts contacts(setting(s.problem));
    Outcome o;
    o.tallies.impulse_on_beads.resize(2, Vector3::Zero());
    const Vector3 point = (row(b.position, pairs[0].first) + row(b.position, pairs[0].second)) / 2.0;
    o.before = motion(b, point);
    ThreadPool team(1);
    contacts.resolve(b, pairs, o.tallies, team);
    o.after = motion(b, point);
    return o;
}

std::int64_t impulses(const Counters& t) { return t.bead_bead + t.bead_rod + t.rod_rod; }

} // namespace

TEST_CASE("impulses keep momentum and angular momentum, and energy never grows") {
    RandomStream random(31);
    for (const Kind kind : {Kind::bead_bead, Kind::bead_rod, Kind::rod_rod}) {
        int hits = 0;
        for (int n = 0; n < 3000; ++n) {
            const Surface surface{random.log_uniform(0.01, 2.0), n % 10 == 0 ? 1.0 : random.uniform()};
            Scene scene = random_scene(random, surface);
            const Pair pair = bring_together(scene, kind, random);
            const Outcome o = collide(scene, {pair});
            if (impulses(o.tallies) == 0) {
                REQUIRE(o.before.energy == o.after.energy);
                continue;
            }
            ++hits;
            REQUIRE((o.after.momentum - o.before.momentum).norm() <= 1e-14 * o.before.momentum_scale);
            // the middle of the overlap is found from either side: places of 1e-2 m carry 2e-18 m of
            // rounding, arms 4e-4 m
            REQUIRE((o.after.angular - o.before.angular).norm() <= 1e-13 * o.before.angular_scale);
            REQUIRE(o.after.energy <= o.before.energy * (1.0 + 1e-14));
        }
        CHECK(hits > 1000); // half of them approach
    }
}

TEST_CASE("without friction and losses an impact keeps the energy") {
    RandomStream random(32);
    for (const Kind kind : {Kind::bead_bead, Kind::bead_rod, Kind::rod_rod})
        for (int n = 0; n < 300; ++n) {
            Scene scene = random_scene(random, {0.0, 1.0});
            const Pair pair = bring_together(scene, kind, random);
            const Outcome o = collide(scene, {pair});
            REQUIRE(std::abs(o.after.energy - o.before.energy) <= 1e-14 * o.before.energy);
        }
}

TEST_CASE("momentum and energy checks see an impulse that is not returned") {
    RandomStream random(33);
    Scene scene = random_scene(random, {0.1, 0.5});
    Bodies b = make_bodies(scene.problem, scene.state);
    const Motion before = motion(b, Vector3::Zero());
    row(b.velocity, 0) *= 1.0 + 1e-12;
    CHECK((motion(b, Vector3::Zero()).momentum - before.momentum).norm() > 1e-14 * before.momentum_scale);
}

TEST_CASE("what a rod gave to the beads is reported") {
    RandomStream random(34);
    for (int n = 0; n < 100; ++n) {
        Scene scene = random_scene(random, {0.1, 0.5});
        const Pair pair = bring_together(scene, Kind::bead_rod, random);
        Bodies b = make_bodies(scene.problem, scene.state);
        Counters tallies;
        tallies.impulse_on_beads.resize(2, Vector3::Zero());
        const Vector3 before = row(b.velocity, 0);
        ThreadPool team(1);
        PairContacts(setting(scene.problem)).resolve(b, std::vector{pair}, tallies, team);
        REQUIRE((b.bead_mass * (row(b.velocity, 0) - before) - tallies.impulse_on_beads[0]).norm() <=
                1e-14 * b.bead_mass * 0.3);
        REQUIRE(tallies.impulse_on_beads[1] == Vector3::Zero());
    }
}

namespace {

/// How long ago two spheres touched, by bisection; negative if they did not approach then.
double touched_before(const Bodies& b, const Pair& pair) {
    const Vector3 r = row(b.position, pair.first) - row(b.position, pair.second),
                  v = b.velocity_of(pair.first) - b.velocity_of(pair.second);
    const double reach = b.radius[pair.first] + b.radius[pair.second], nearest = r.dot(v) / v.squaredNorm();
    double inside = std::max(nearest, 0.0), outside = 10.0 * reach / v.norm();
    for (int k = 0; k < 100; ++k)
        ((r - v * (inside + outside) / 2.0).norm() < reach ? inside : outside) = (inside + outside) / 2.0;
    return inside;
}

} // namespace

TEST_CASE("of several contacts of a clump with one partner only the first to touch acts") {
    for (const bool rods : {false, true}) {
        RandomStream random(35);
        int compared = 0;
        for (int n = 0; n < 3000; ++n) {
            Scene scene = random_scene(random, {0.1, 0.5});
            scene.problem.time_step = 1.0; // all of them met within the step
            bring_together(scene, rods ? Kind::rod_rod : Kind::bead_rod, random);
            const Bodies b = make_bodies(scene.problem, scene.state);
            std::vector<Pair> all;
            Pair earliest{0, 0};
            double longest = -1.0, deepest = 0.0; // of the smaller radius
            for (const auto& [i, j] : beds::all_overlaps(b, box)) {
                all.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
                const double back = touched_before(b, all.back()), reach = b.radius[i] + b.radius[j];
                deepest = std::max(deepest, (reach - (row(b.position, i) - row(b.position, j)).norm()) /
                                                std::min(b.radius[i], b.radius[j]));
                if (back > longest) {
                    longest = back;
                    earliest = all.back();
                }
            }
            if (all.size() < 2 || deepest > 0.05) // deeper ones are swept again
                continue;
            const Outcome together = collide(scene, all), alone = collide(scene, {earliest});
            REQUIRE(impulses(together.tallies) <= 1);
            REQUIRE(together.after.energy == alone.after.energy);
            REQUIRE(together.after.momentum == alone.after.momentum);
            compared += impulses(together.tallies) == 1 ? 1 : 0;
        }
        CHECK(compared > 20);
    }
}

TEST_CASE("the worst overlap is reported in radii, across the edge of the box too") {
    Scene scene;
    scene.problem.beads = 2;
    scene.problem.box = box;
    scene.state.beads.resize(2);
    scene.state.beads.x = {0.5 * a, 7.0 * box - a}; // 1.5 a apart, seven boxes on
    Bodies b = make_bodies(scene.problem, scene.state);
    Counters tallies;
    ThreadPool team(1);
    const WorstOverlap worst =
        PairContacts(setting(scene.problem)).resolve(b, std::vector<Pair>{{0, 1}}, tallies, team);
    CHECK(worst.radii == Approx(0.5).epsilon(1e-11)); // 7 boxes of 0.05 m: rounding 6e-17 m of 4e-4 m
    CHECK(tallies.max_overlap == worst.radii);
    CHECK(tallies.overlaps == 1);
    CHECK(tallies.bead_bead == 0); // not approaching
}

namespace {

GranularProblem hot_gas(double side, std::size_t beads, std::vector<RodSpec> rods, double speed) {
    GranularProblem problem = beds::still_plates(1.2e-3, side * a);
    problem.beads = beads;
    problem.rods = std::move(rods);
    problem.start_speed = speed;
    problem.start = Start::random;
    beds::set_contacts(problem, {0.0, 1.0}); // stays hot
    return problem;
}

std::vector<RodSpec> three_rods(double side) {
    return {beds::short_rod(0.2 * side * a, 0.2 * side * a, 0.3),
            beds::short_rod(0.2 * side * a, 0.7 * side * a, 1.2),
            beds::short_rod(0.7 * side * a, 0.4 * side * a, -2.0)};
}

/// Steps at which the number of overlaps was not that of a run whose lists are new, or those are not all.
int missed_steps(const GranularProblem& problem, State start, int steps, std::int64_t& overlaps,
                 SimulationCost& cost) {
    Simulation run(problem, start);
    ThreadPool team(1);
    int missed = 0;
    for (int n = 0; n < steps && !run.failure(); ++n) {
        const State state = run.state();
        const Bodies bodies = make_bodies(problem, state);
        if (PairFinder(bodies, problem.box).find(bodies, still, problem.time_step, team).size() !=
            beds::all_overlaps(bodies, problem.box).size())
            ++missed;
        Simulation fresh(problem, state);
        const std::int64_t before = run.tallies().overlaps;
        run.advance(1);
        fresh.advance(1);
        missed += run.tallies().overlaps - before == fresh.tallies().overlaps ? 0 : 1;
    }
    CHECK_FALSE(run.failure());
    overlaps = run.tallies().overlaps;
    cost = run.cost();
    return missed;
}

State shifted(State state, double boxes, double side) {
    RandomStream random(36);
    for (std::size_t i = 0; i < state.beads.size(); ++i) {
        state.beads.x[i] += side * std::round(random.uniform(-boxes, boxes));
        state.beads.y[i] += side * std::round(random.uniform(-boxes, boxes));
    }
    for (RodBody& rod : state.rods)
        rod.position.x() += side * std::round(random.uniform(-boxes, boxes));
    return state;
}

} // namespace

TEST_CASE("no overlap is missed in a hot gas") {
    struct Gas {
        GranularProblem problem;
        int steps;
    };
    const std::vector<Gas> gases{{hot_gas(8.0, 8, {beds::short_rod(4 * a, 2 * a, 0.0)}, 0.3), 2000},
                                 {hot_gas(20.0, 75, three_rods(20.0), 0.2), 1500}, // dense
                                 {hot_gas(24.0, 30, three_rods(24.0), 1.0), 1500}, // dilute and fast
                                 {hot_gas(24.0, 60, three_rods(24.0), 2.0),
                                  800}, // refreshed nearly every step; faster beads trip the guard
                                 {hot_gas(16.0, 50, {}, 0.05), 2000}};
    for (const Gas& gas : gases)
        for (const double boxes : {0.0, 300.0}) {
            std::int64_t overlaps = 0;
            SimulationCost cost;
            CAPTURE(gas.problem.beads, gas.problem.start_speed, boxes);
            CHECK(missed_steps(gas.problem, shifted(make_start(gas.problem, 0), boxes, gas.problem.box.x),
                               gas.steps, overlaps, cost) == 0);
            CHECK(overlaps > 100);
            CHECK(cost.list_refreshes > 50);
            CHECK(cost.list_rebuilds >= 2);
        }
}

TEST_CASE("no overlap is missed among rods, held and free, and a dense shaken bed") {
    GranularProblem problem;
    problem.box = 30 * a;
    problem.beads = 190;
    problem.rods = {beds::long_rod(15 * a, 8 * a, 0.0), beds::long_rod(15 * a, 22 * a, 2.0)};
    problem.rods[1].imposed_speed = 0.02;
    problem.equilibration_steps = 500;
    std::int64_t overlaps = 0;
    SimulationCost cost;
    CHECK(missed_steps(problem, make_start(problem, 0), 2000, overlaps, cost) == 0);
    CHECK(overlaps > 500);
}

TEST_CASE("a part of the list names the blocks of all its beads, also behind a rod's spheres") {
    GranularProblem problem = beds::still_plates(1.2e-3, 200.0 * a);
    problem.beads = 2049; // a block, and one bead of the next, which has the rod's spheres too
    problem.rods = {beds::short_rod(190.0 * a, 190.0 * a, 0.0)};
    State state = make_start(problem, 0);
    const auto put = [&](std::size_t bead, double x, double y) {
        state.beads.x[bead] = x;
        state.beads.y[bead] = y;
    };
    for (std::size_t i = 0; i < problem.beads; ++i)
        put(i, 4.0 * a * static_cast<double>(i % 45), 4.0 * a * static_cast<double>(i / 45));
    put(2046, state.rods[0].position.x(), state.rods[0].position.y() + 2.0 * a);
    put(2047, 185.0 * a, 100.0 * a);
    put(2048, 187.0 * a, 100.0 * a);
    const Bodies bodies = make_bodies(problem, state);
    PairFinder finder(bodies, problem.box);
    ThreadPool team(1);
    finder.find(bodies, still, problem.time_step, team);
    REQUIRE(finder.cost().inner_pairs >= 2);
    CHECK(std::ranges::count(finder.blocks_of(0), 1U) == 1);
}

TEST_CASE("the search notices a list that is too old") {
    GranularProblem problem = hot_gas(24.0, 60, {}, 1.0);
    const State start = make_start(problem, 0);
    Bodies b = make_bodies(problem, start);
    PairFinder finder(b, problem.box);
    ThreadPool team(1);
    int missed = 0;
    for (int n = 0; n < 300; ++n) {
        for (std::size_t i = 0; i < b.beads; ++i)
            row(b.position, i) +=
                row(b.velocity, i) * problem.time_step; // and the finder is given velocities of zero
        missed +=
            finder.find(b, still, problem.time_step, team).size() == beds::all_overlaps(b, problem.box).size()
                ? 0
                : 1;
    }
    CHECK(missed > 0);
}
