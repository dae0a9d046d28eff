// Beads of several sizes: how they are drawn, their impacts, and what must not change if all sizes are equal.

#include "starts.hpp"

#include "granular/pair_finder.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace starts;
using namespace rodwake::granular;

namespace {

constexpr double b = 1.4 * a;

/// Half of the beads 1.4 times as large as the others.
GranularProblem mixture(double phi, double box_in_a, double gap) {
    GranularProblem problem = bed(phi, Start::random, box_in_a);
    problem.bead_kinds = {{a, 0.5}, {b, 0.5}};
    problem.beads = static_cast<std::size_t>(phi * box_in_a * box_in_a / (M_PI * 1.48));
    problem.plates.gap = gap;
    return problem;
}

std::uint64_t hash_after(const GranularProblem& problem, std::int64_t steps) {
    Simulation simulation(problem, make_start(problem, 0));
    simulation.advance(steps);
    REQUIRE_FALSE(simulation.failure());
    return state_hash(simulation.state());
}

/// Beads on a square grid in one plane, every `of`-th large, with velocities in it; nothing takes energy.
struct Discs {
    GranularProblem problem;
    State state;

    Discs(double phi, double ratio, std::size_t of) {
        constexpr std::size_t side = 20;
        const double large = ratio * a, share = 1.0 / static_cast<double>(of),
                     square = (1.0 - share) * a * a + share * large * large,
                     spacing = std::sqrt(M_PI * square / phi);
        problem = beds::still_plates(2.02 * large, side * spacing);
        problem.gravity = 0.0;
        problem.time_step = 4e-5; // a disc meets 0.03 others a step at most: Z is off by 0.2 % at most
        problem.bead_kinds = {{a, 1.0 - share}, {large, share}};
        problem.beads = side * side;
        problem.steps = 1'000'000;
        beds::set_contacts(problem, {0.0, 1.0});
        state.beads.resize(problem.beads);
        RandomStream random(59);
        for (std::size_t i = 0; i < problem.beads; ++i) {
            state.beads.x[i] = (static_cast<double>(i % side) + 0.5) * spacing;
            state.beads.y[i] = (static_cast<double>(i / side) + 0.5) * spacing;
            state.beads.z[i] = 0.5 * problem.plates.gap;
            state.beads.vx[i] = 0.1 * random.normal();
            state.beads.vy[i] = 0.1 * random.normal();
            const bool is_large = (i + i / side) % of == 0;
            state.beads.radius.push_back(is_large ? large : a);
            state.beads.kind.push_back(is_large ? 1 : 0);
        }
    }
};

} // namespace

TEST_CASE("shares give whole numbers of beads by largest remainders") {
    const BeadMix mix{a, {{a, 1.0}, {b, 1.0}, {2.0 * a, 1.0}}};
    CHECK(mix.counts(10) == std::vector<std::size_t>{4, 3, 3});
    CHECK(mix.counts(2) == std::vector<std::size_t>{1, 1, 0});
    CHECK(BeadMix{a, {{a, 0.3}, {b, 0.7}}}.counts(5) == std::vector<std::size_t>{2, 3}); // 1.5 and 3.5
    CHECK(BeadMix{a, {{a, 1.0}, {b, 3.0}}}.counts(7) == std::vector<std::size_t>{2, 5}); // 1.75 and 5.25
    CHECK(BeadMix{a}.counts(7) == std::vector<std::size_t>{7});
    CHECK(mix.smallest() == a);
    CHECK(mix.largest() == 2.0 * a);
    CHECK(mix.root_mean_square() == Approx(a * std::sqrt((1.0 + 1.96 + 4.0) / 3.0)).epsilon(1e-15));
    CHECK_FALSE(mix.equal());
    CHECK(BeadMix{a, {{b, 1.0}, {b, 2.0}}}.equal());
    CHECK_FALSE(BeadMix{a, {}, 0.01}.equal());
}

TEST_CASE("radii of a spread are normal, cut at two deviations, and cover what they are to cover") {
    GranularProblem problem = bed(0.5, Start::random, 400.0);
    problem.bead_spread = 0.05;
    problem.bead_area = 0.4999 * bed_area(problem);
    const BeadSizes sizes = bead_sizes(problem, 3);
    REQUIRE(sizes.radius.size() == problem.beads);
    double squares = 0.0;
    for (const double radius : sizes.radius)
        squares += radius * radius;
    CHECK(M_PI * squares == Approx(problem.bead_area).epsilon(1e-13)); // rounding of 25 000 terms
    CHECK(bead_area_fraction(problem) == Approx(0.4999).epsilon(1e-15));
    const double middle = mean(sizes.radius, 1),
                 deviation = std::sqrt(squares / static_cast<double>(problem.beads) - middle * middle);
    CHECK(middle == Approx(a).epsilon(2e-3));                          // (1 + 0.774 spread^2)^(-1/2)
    CHECK(deviation / middle == Approx(0.05 * 0.8796).epsilon(0.015)); // 3 errors of 25 000 numbers
    const auto [least, most] = std::ranges::minmax(sizes.radius);
    CHECK(most / least <= 1.1 / 0.9 * (1.0 + 1e-15));
    CHECK(most / least > 1.095 / 0.905);
    // Each bead draws on its own: fewer of them have the same radii, but for the common factor.
    problem.beads = 100;
    problem.bead_area = 0.0;
    const BeadSizes fewer = bead_sizes(problem, 3), other = bead_sizes(problem, 4);
    CHECK(fewer.radius[7] / fewer.radius[8] == Approx(sizes.radius[7] / sizes.radius[8]).epsilon(1e-14));
    CHECK(other.radius[7] / other.radius[8] != Approx(sizes.radius[7] / sizes.radius[8]).epsilon(1e-6));
    CHECK(std::accumulate(fewer.radius.begin(), fewer.radius.end(), 0.0, [](double sum, double r) {
              return sum + r * r;
          }) == Approx(100.0 * a * a).epsilon(1e-13));
}

TEST_CASE("kinds are dealt at random, in the numbers of their shares") {
    const GranularProblem problem = mixture(0.6, 60.0, 1.55e-3);
    const BeadSizes sizes = bead_sizes(problem, 0);
    const auto large = static_cast<std::size_t>(std::ranges::count(sizes.kind, 1));
    CHECK(large == problem.beads / 2);
    std::size_t changes = 0;
    for (std::size_t i = 0; i < problem.beads; ++i) {
        REQUIRE(sizes.radius[i] == (sizes.kind[i] == 1 ? b : a));
        changes += i > 0 && sizes.kind[i] != sizes.kind[i - 1];
    }
    CHECK(std::abs(static_cast<double>(changes) - 0.5 * static_cast<double>(problem.beads)) <
          4.0 * std::sqrt(0.25 * static_cast<double>(problem.beads)));
    CHECK(sizes.kind != bead_sizes(problem, 1).kind);
}

TEST_CASE("equal beads given as several kinds move to the bit as one kind") {
    for (const Start start : {Start::lattice, Start::random})
        for (const bool with_rod : {false, true}) {
            GranularProblem one = bed(0.6, start, 30.0);
            one.steps = 400;
            if (with_rod)
                add_rod(one, 15.0, 15.0, 0.3);
            GranularProblem two = one;
            two.bead_kinds = {{a, 0.3}, {a, 0.7}};
            INFO((start == Start::random ? "random" : "lattice") << (with_rod ? " with a rod" : ""));
            CHECK(hash_after(two, 400) == hash_after(one, 400));
        }
    // and of a radius that is not the unit of length as beads of that radius
    GranularProblem larger = bed(0.4, Start::random, 30.0);
    larger.steps = 400;
    GranularProblem kinds = larger;
    larger.bead_radius = 1.1 * a;
    kinds.bead_kinds = {{1.1 * a, 1.0}, {1.1 * a, 1.0}};
    CHECK(hash_after(kinds, 400) == hash_after(larger, 400));
}

TEST_CASE("a start of two sizes overlaps nowhere, up to 0.82 of 1 : 1.4") {
    for (const double phi : {0.3, 0.7, 0.82})
        check_start(mixture(phi, 40.0, 1.55e-3));
    GranularProblem with_rod = mixture(0.7, 40.0, 1.55e-3);
    add_rod(with_rod, 20.0, 20.0, 0.7);
    check_start(with_rod, 2);
    GranularProblem spread = bed(0.78, Start::lattice, 40.0);
    spread.bead_spread = 0.03;
    check_start(spread);
}

TEST_CASE("a start of two sizes rests as a whole, and lattices of them are refused") {
    GranularProblem problem = mixture(0.6, 40.0, 1.55e-3);
    const State state = make_start(problem, 0);
    double momentum = 0.0, sizes = 0.0;
    for (std::size_t i = 0; i < problem.beads; ++i) {
        momentum += bead_mass(problem, state.beads.radius[i]) * state.beads.vx[i];
        sizes += bead_mass(problem, state.beads.radius[i]) * std::abs(state.beads.vx[i]);
    }
    CHECK(std::abs(momentum) < 1e-13 * sizes);
    problem.start = Start::lattice;
    CHECK_THROWS_WITH(make_start(problem, 0), Catch::Contains("of different radii: use start = \"random\""));
    problem = mixture(0.6, 40.0, 1.1e-3);
    CHECK_THROWS_WITH(make_start(problem, 0), Catch::Contains("larger than the largest bead diameter"));
}

TEST_CASE("two beads of different masses exchange what an elastic impact does") {
    GranularProblem problem = beds::still_plates(2.0e-3, 30 * a);
    problem.gravity = 0.0;
    problem.beads = 2;
    problem.bead_kinds = {{a, 1.0}, {b, 1.0}};
    problem.steps = 1000;
    beds::set_contacts(problem, {0.0, 1.0});
    State state;
    state.beads.resize(2);
    state.beads.radius = {a, b};
    state.beads.kind = {0, 1};
    state.beads.x = {10 * a, 13 * a};
    state.beads.y = {10 * a, 10 * a};
    state.beads.z = {1.0e-3, 1.0e-3};
    state.beads.vx = {0.2, -0.05};
    Simulation simulation(problem, state);
    simulation.advance(1000);
    const double m = 1.0, M = 1.4 * 1.4 * 1.4, common = (m * 0.2 - M * 0.05) / (m + M);
    const Beads after = simulation.state().beads;
    CHECK(simulation.tallies().bead_bead == 1);
    CHECK(after.vx[0] == Approx(2.0 * common - 0.2).epsilon(1e-13));
    CHECK(after.vx[1] == Approx(2.0 * common + 0.05).epsilon(1e-13));
    // They touched where the gap of 0.6 a was closed, and flew on from there.
    const double touch = 0.6 * a / 0.25, rest = 1000 * problem.time_step - touch;
    CHECK(after.x[0] == Approx(10 * a + 0.2 * touch + after.vx[0] * rest).epsilon(1e-12));
    CHECK(after.x[1] == Approx(13 * a - 0.05 * touch + after.vx[1] * rest).epsilon(1e-12));
}

TEST_CASE("rough impacts of different beads keep momentum and angular momentum, and take energy") {
    GranularProblem problem = beds::still_plates(4.0e-3, 30 * a);
    problem.gravity = 0.0;
    problem.beads = 2;
    problem.bead_kinds = {{a, 1.0}, {b, 1.0}};
    problem.steps = 1000;
    RandomStream random(7);
    int hits = 0;
    for (int trial = 0; trial < 40; ++trial) {
        State state;
        state.beads.resize(2);
        state.beads.radius = {a, b};
        state.beads.kind = {0, 1};
        state.beads.x = {10 * a, 12.6 * a};
        state.beads.y = {10 * a, (10 + random.uniform(-1.0, 1.0)) * a};
        state.beads.z = {2e-3, 2e-3 + random.uniform(-1.0, 1.0) * a};
        state.beads.vx = {0.2, 0.0};
        state.beads.wy = {random.uniform(-300.0, 300.0), random.uniform(-300.0, 300.0)};
        state.beads.wz = {random.uniform(-300.0, 300.0), random.uniform(-300.0, 300.0)};
        const auto momenta = [&](const Beads& beads) {
            std::pair<Eigen::Vector3d, Eigen::Vector3d> sum{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
            for (std::size_t i = 0; i < 2; ++i) {
                const double mass = bead_mass(problem, beads.radius[i]);
                const Eigen::Vector3d v(beads.vx[i], beads.vy[i], beads.vz[i]),
                    r(beads.x[i], beads.y[i], beads.z[i]), w(beads.wx[i], beads.wy[i], beads.wz[i]);
                sum.first += mass * v;
                sum.second += mass * r.cross(v) + 0.4 * mass * beads.radius[i] * beads.radius[i] * w;
            }
            return sum;
        };
        Simulation simulation(problem, state);
        const auto before = momenta(state.beads);
        const double energy = simulation.energy().kinetic;
        simulation.advance(300); // 1.2 mm: beyond the other bead, short of the plates
        if (simulation.tallies().bead_bead != 1)
            continue;
        ++hits;
        const auto after = momenta(simulation.state().beads);
        CHECK((after.first - before.first).norm() < 1e-14 * before.first.norm());
        CHECK((after.second - before.second).norm() < 1e-13 * before.second.norm());
        CHECK(simulation.energy().kinetic < energy);
    }
    CHECK(hits > 30);
}

TEST_CASE("a bed of two sizes keeps its energy where nothing takes it") {
    GranularProblem problem = mixture(0.6, 30.0, 1.55e-3);
    problem.plates.gamma = 0.0;
    problem.time_step = 2e-5;
    problem.start_speed = 0.1;
    problem.steps = 5000;
    beds::set_contacts(problem, {0.0, 1.0});
    Simulation simulation(problem, make_start(problem, 0));
    const Energy before = simulation.energy();
    simulation.advance(5000);
    REQUIRE_FALSE(simulation.failure());
    const Energy after = simulation.energy();
    CHECK(simulation.tallies().bead_bead > 4000);
    CHECK(simulation.tallies().bead_plate > 1000);
    CHECK(after.kinetic + after.potential == Approx(before.kinetic + before.potential).epsilon(1e-8));
}

TEST_CASE("a bed of two sizes finds all overlaps, and goes on from its state to the bit") {
    GranularProblem problem = mixture(0.75, 40.0, 1.55e-3);
    problem.time_step = 2e-5;
    add_rod(problem, 20.0, 20.0, 0.3);
    problem.steps = 3000;
    Simulation simulation(problem, make_start(problem, 0));
    // Overlaps of each step are those of a run whose lists are new, and new lists find all that there are.
    ThreadPool team(1);
    const std::vector<double> still{0.0};
    std::int64_t overlaps = 0;
    for (int k = 0; k < 150; ++k) {
        const State state = simulation.state();
        const Bodies bodies = make_bodies(problem, state);
        REQUIRE(PairFinder(bodies, problem.box).find(bodies, still, problem.time_step, team).size() ==
                beds::all_overlaps(bodies, problem.box).size());
        Simulation fresh(problem, state);
        const std::int64_t before = simulation.tallies().overlaps;
        simulation.advance(1);
        fresh.advance(1);
        REQUIRE_FALSE(simulation.failure());
        REQUIRE(simulation.tallies().overlaps - before == fresh.tallies().overlaps);
        overlaps += fresh.tallies().overlaps;
    }
    CHECK(overlaps > 300);
    Simulation resumed(problem, simulation.state(), simulation.tallies());
    simulation.advance(200);
    resumed.advance(200);
    CHECK(state_hash(simulation.state()) == state_hash(resumed.state()));
    CHECK(resumed.state().beads.radius == simulation.state().beads.radius);
    CHECK(simulation.agitation().of_kinds.size() == 2);
}

TEST_CASE("threads change no bit of a bed of two sizes", "[threads]") {
    GranularProblem problem = mixture(0.6, 160.0, 1.55e-3);
    problem.steps = 50;
    REQUIRE(problem.beads > 3000); // more than one block
    const State start = make_start(problem, 0);
    Simulation one(problem, start, {}, 1), three(problem, start, {}, 3);
    one.advance(50);
    three.advance(50);
    CHECK(state_hash(one.state()) == state_hash(three.state()));
}

// Z = (1 - s)/(1 - phi) + s Z_1(phi), s = <a>^2/<a^2> (Santos, Yuste & Lopez de Haro, Mol. Phys. 96, 1,
// 1999); Z_1 of equal discs: the Pade approximant of ten virial coefficients (studies/reports/bed.md).
TEST_CASE("spheres of two sizes in one plane stay in it and have the pressure of hard discs") {
    struct Case {
        double phi, ratio;
        std::size_t of;
        double equal_discs;
    };
    for (const Case& c : {Case{0.5, 1.4, 2, 4.1084}, Case{0.3, 2.0, 4, 2.0635}}) {
        Discs discs(c.phi, c.ratio, c.of);
        Simulation simulation(discs.problem, discs.state);
        const double energy = simulation.energy().kinetic;
        simulation.advance(8000); // tens of impacts a disc: the grid melts
        const PlaneTensor then = simulation.tallies().virial;
        const std::int64_t begun = simulation.step(), impacts = simulation.tallies().bead_bead;
        while (simulation.tallies().bead_bead < impacts + 250'000)
            simulation.advance(1000);
        REQUIRE_FALSE(simulation.failure());
        const State state = simulation.state();
        CHECK(std::ranges::all_of(state.beads.z, [&](double z) { return z == discs.state.beads.z[0]; }));
        CHECK(std::ranges::all_of(state.beads.vz, [](double v) { return v == 0.0; }));
        const PlaneTensor flux = simulation.agitation().momentum_flux, now = simulation.tallies().virial;
        const double time = static_cast<double>(simulation.step() - begun) * discs.problem.time_step,
                     carried = (now[0] + now[2] - then[0] - then[2]) / time, heat = flux[0] + flux[2];
        const double large = c.ratio, share = 1.0 / static_cast<double>(c.of),
                     s = std::pow(1.0 - share + share * large, 2) / (1.0 - share + share * large * large);
        const double Z = (1.0 - s) / (1.0 - c.phi) + s * c.equal_discs;
        INFO("phi " << c.phi << ", 1 : " << c.ratio);
        CHECK(simulation.energy().kinetic == Approx(energy).epsilon(1e-9));
        CHECK(1.0 + carried / heat == Approx(Z).epsilon(0.01)); // 0.3 % of scatter, 0.5 % of the formula
        // Equipartition: m T is the same of both kinds, to 3 errors of a frame of 100 to 300 of them.
        const auto kinds = simulation.agitation().of_kinds;
        CHECK(kinds[1].xy * std::pow(c.ratio, 3) == Approx(kinds[0].xy).epsilon(0.45));
    }
}

TEST_CASE("sizes that cannot be are refused") {
    GranularProblem problem = mixture(0.6, 40.0, 1.55e-3);
    problem.bead_kinds[1].radius = -b;
    CHECK_THROWS_WITH(validate(problem), Catch::Contains("bead kind 1: radius = -0.00056: must be > 0"));
    problem.bead_kinds[1] = {b, 0.0};
    CHECK_THROWS_WITH(validate(problem), Catch::Contains("bead kind 1: share = 0: must be > 0"));
    problem.bead_kinds[1] = {2.0 * a, 0.5};
    CHECK_THROWS_WITH(validate(problem),
                      Catch::Contains("must be larger than the largest bead diameter, 0.0016 m"));
    problem.bead_kinds[1] = {0.04 * a, 0.5};
    CHECK_THROWS_WITH(validate(problem),
                      Catch::Contains("the largest must be at most 20 times the smallest"));
    problem = mixture(0.6, 40.0, 1.55e-3);
    problem.bead_spread = 0.3;
    CHECK_THROWS_WITH(validate(problem), Catch::Contains("bead_spread = 0.3: must be between 0 and 0.2"));
    problem = mixture(0.6, 40.0, 1.55e-3);
    State state = make_start(problem, 0);
    state.beads.kind[3] = 2;
    CHECK_THROWS_WITH(Simulation(problem, state), Catch::Contains("kinds that the scene does not have"));
    state = make_start(problem, 0);
    state.beads.radius.pop_back();
    CHECK_THROWS_WITH(Simulation(problem, state), Catch::Contains("radii that do not fit"));
}

TEST_CASE("a bed of two sizes goes on in another run with its own radii") {
    GranularProblem problem = mixture(0.6, 40.0, 1.55e-3);
    const State stored = make_start(problem, 0);
    GranularProblem fewer = problem;
    fewer.beads -= 30;
    const State next = restart_from(fewer, stored, 1);
    REQUIRE(next.beads.radius.size() == fewer.beads);
    CHECK(clearance(next, fewer) > 0.0);
    // Every bead that is left is one of the stored ones, of its radius and kind.
    for (std::size_t i = 0; i < fewer.beads; ++i) {
        const auto same = std::ranges::find(stored.beads.vx, next.beads.vx[i]) - stored.beads.vx.begin();
        REQUIRE(same < static_cast<std::ptrdiff_t>(problem.beads));
        REQUIRE(next.beads.radius[i] == stored.beads.radius[static_cast<std::size_t>(same)]);
        REQUIRE(next.beads.kind[i] == stored.beads.kind[static_cast<std::size_t>(same)]);
    }
    fewer.bead_kinds = {};
    CHECK_THROWS_WITH(restart_from(fewer, stored, 1), Catch::Contains("kinds are numbered from 0 to 0"));
    fewer.bead_kinds = {{a, 0.5}, {1.3 * a, 0.5}};
    CHECK_THROWS_WITH(restart_from(fewer, stored, 1), Catch::Contains("give the sizes of these beads"));
}
