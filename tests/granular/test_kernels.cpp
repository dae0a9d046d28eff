// The vector loops: plain arithmetic, the same bits on every instruction set.

#include "beds.hpp"

#include "granular/kernels.hpp"
#include "granular/pair_finder.hpp"
#include "support/instruction_sets.hpp"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstring>
#include <set>

using namespace rodwake;
using namespace rodwake::granular;

namespace {

/// Runs the test on each instruction set of this machine; their names.
template<class Test>
std::set<std::string> on_every_target(const Test& test) {
    std::set<std::string> names;
    for_each_instruction_set([&] {
        names.insert(vector_target());
        test();
    });
    return names;
}

using Rows = decltype(Bodies::position);

Rows random_rows(RandomStream& random, std::size_t count, double size) {
    Rows rows(4 * count, 0.0);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            rows[4 * i + k] = random.uniform(-size, size);
    return rows;
}

template<class Numbers>
std::vector<std::uint64_t> bits(const Numbers& numbers) {
    std::vector<std::uint64_t> all;
    for (const double x : numbers)
        all.push_back(std::bit_cast<std::uint64_t>(x));
    return all;
}

struct Flown {
    std::vector<std::uint64_t> position, velocity, low, high;
    std::vector<std::uint32_t> out;
    bool operator==(const Flown&) const = default;
};

Flown fly(Rows position, Rows velocity, std::size_t begin, std::size_t end) {
    BodyRange range = BodyRange::empty();
    std::vector<std::uint32_t> out;
    drift(position.data(), velocity.data(), begin, end, {2e-5, 9.81, -5e-4, 5e-4}, range, out);
    return {bits(position), bits(velocity), bits(std::vector<double>(range.low, range.low + 3)),
            bits(std::vector<double>(range.high, range.high + 3)), out};
}

/// What drift has to do, one bead after the other.
Flown fly_plainly(Rows position, Rows velocity, std::size_t begin, std::size_t end) {
    BodyRange range = BodyRange::empty();
    std::vector<std::uint32_t> out;
    for (std::size_t i = begin; i < end; ++i) {
        double *x = &position[4 * i], *v = &velocity[4 * i];
        range.include(v);
        for (int k = 0; k < 3; ++k) { // adding nothing still turns -0 into 0
            x[k] = x[k] + v[k] * 2e-5 + (k == 2 ? -9.81 * 2e-5 * 2e-5 / 2.0 : 0.0);
            v[k] += k == 2 ? -9.81 * 2e-5 : 0.0;
        }
        if (!(x[2] > -5e-4 && x[2] < 5e-4) || !std::isfinite(x[0]) || !std::isfinite(x[1]))
            out.push_back(static_cast<std::uint32_t>(i));
    }
    return {bits(position), bits(velocity), bits(std::vector<double>(range.low, range.low + 3)),
            bits(std::vector<double>(range.high, range.high + 3)), out};
}

} // namespace

TEST_CASE("beads fly the same on every instruction set") {
    RandomStream random(21);
    for (const std::size_t count : {0u, 1u, 2u, 3u, 7u, 64u, 501u}) {
        Rows position = random_rows(random, count, 6e-4), velocity = random_rows(random, count, 0.3);
        for (std::size_t i = 0; i < count; i += 2)
            position[4 * i] = velocity[4 * i] = velocity[4 * i + 1] = -0.0;
        for (const std::size_t begin : {std::size_t{0}, count / 3}) {
            const Flown wanted = fly_plainly(position, velocity, begin, count);
            const auto names =
                on_every_target([&] { CHECK(fly(position, velocity, begin, count) == wanted); });
            CHECK(names.size() >= 2);
        }
    }
}

TEST_CASE("a bead whose place is not a number is out, on every instruction set") {
    RandomStream random(22);
    const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, inf, -inf})
        for (const std::size_t i : {0u, 5u, 12u})
            for (const std::size_t axis : {0u, 1u, 2u}) {
                Rows position = random_rows(random, 13, 1e-4), velocity = random_rows(random, 13, 0.1);
                position[4 * i + axis] = bad;
                on_every_target([&] {
                    CHECK(fly(position, velocity, 0, 13).out ==
                          std::vector<std::uint32_t>{static_cast<std::uint32_t>(i)});
                });
            }
}

TEST_CASE("pairs are selected alike on every instruction set") {
    RandomStream random(23);
    const PeriodicBox box{8e-3, 6.1e-3};
    for (const std::size_t count : {2u, 3u, 40u, 300u}) {
        Rows position = random_rows(random, count, 3.0 * box.x); // several boxes
        PairList list;
        for (std::uint32_t i = 0; i < count; ++i)
            for (std::uint32_t j = i + 1; j < count && list.size() < 5003; ++j) {
                position[4 * i + 2] *= 0.02;
                list.pairs.push_back({i, j});
                list.reach.push_back(random.uniform(5e-4, 3e-3));
            }
        const auto find = [&](bool near, std::size_t begin) {
            std::vector<std::uint32_t> found(list.size() + 8);
            const std::size_t n =
                near ? within_reach(position.data(), list, begin, list.size(), box, 4e-4, found.data())
                     : overlapping(position.data(), list, begin, list.size(), box, found.data());
            found.resize(n);
            return found;
        };
        const auto plain = [&](bool near, std::size_t begin) {
            std::vector<std::uint32_t> found;
            for (std::size_t k = begin; k < list.size(); ++k) {
                const double *p = &position[4 * list.pairs[k].first],
                             *q = &position[4 * list.pairs[k].second];
                double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
                d[0] -= box.x * std::nearbyint(d[0] * (1.0 / box.x));
                d[1] -= box.y * std::nearbyint(d[1] * (1.0 / box.y));
                if (near)
                    d[2] = 0.0;
                const double reach = list.reach_of(k) + (near ? 4e-4 : 0.0);
                if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach)
                    found.push_back(static_cast<std::uint32_t>(k));
            }
            return found;
        };
        const auto compare = [&] {
            for (const bool near : {false, true})
                for (const std::size_t begin : {std::size_t{0}, list.size() / 3}) {
                    const auto wanted = plain(near, begin);
                    CHECK((count < 40 || wanted.size() > 20));
                    on_every_target([&] { CHECK(find(near, begin) == wanted); });
                }
        };
        compare();
        list.reach.clear();
        list.common = 2e-3;
        compare();
    }
}

TEST_CASE("a whole run has the same bits on every instruction set") {
    GranularProblem problem;
    problem.box = 24 * problem.bead_radius;
    problem.beads = 101;
    problem.rods.push_back(beds::long_rod(12 * problem.bead_radius, 12 * problem.bead_radius, 0.4));
    const State start = make_start(problem, 0);
    std::set<std::uint64_t> hashes;
    const auto names = on_every_target([&] {
        Simulation run(problem, start);
        run.advance(2000);
        hashes.insert(state_hash(run.state()));
    });
    CHECK(hashes.size() == 1);
    CHECK(names.size() >= 2);
}

TEST_CASE("cells find all near pairs") {
    RandomStream random(24);
    const double a = 4e-4;
    for (const PeriodicBox box : {PeriodicBox(8 * a), PeriodicBox(9.5 * a, 9 * a), PeriodicBox(8 * a, 60 * a),
                                  PeriodicBox(30 * a), PeriodicBox(40 * a, 22 * a), PeriodicBox(300 * a)})
        for (const double away : {0.0, 1e3}) { // boxes from the origin
            const std::size_t count = 150;
            Bodies bodies;
            bodies.beads = 130;
            bodies.bead_radius = a;
            Rows& position = bodies.position;
            position = random_rows(random, count, box.longer());
            for (double& x : position)
                x += away * box.longer();
            std::vector<double>& radius = bodies.radius;
            radius.assign(count, a);
            std::fill(radius.begin() + 130, radius.end(), 1.3 * a);
            std::vector<std::uint32_t>& rod_of = bodies.rod_of;
            rod_of.assign(20, 0);
            std::fill(rod_of.begin() + 10, rod_of.end(), 1);
            PairList list;
            const double skin = 0.5 * a;
            ThreadPool team(1);
            near_pairs(bodies, box, skin, team, list);
            std::vector<std::pair<std::uint32_t, std::uint32_t>> wanted, found;
            for (std::uint32_t i = 0; i < count; ++i)
                for (std::uint32_t j = i + 1; j < count; ++j) {
                    double d[2] = {position[4 * i] - position[4 * j],
                                   position[4 * i + 1] - position[4 * j + 1]};
                    d[0] -= box.x * std::round(d[0] / box.x);
                    d[1] -= box.y * std::round(d[1] / box.y);
                    if (!(i >= 130 && rod_of[i - 130] == rod_of[j - 130]) &&
                        std::hypot(d[0], d[1]) < radius[i] + radius[j] + skin)
                        wanted.emplace_back(i, j);
                }
            for (const Pair& pair : list.pairs)
                found.emplace_back(pair.first, pair.second);
            CHECK(found == wanted);
            CHECK((box.longer() > 50 * a || wanted.size() > 100));
        }
}
