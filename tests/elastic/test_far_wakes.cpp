// Far wakes as drifting heat: nodes against the exact field, sums against all pairs.

#include "wake_samples.hpp"

#include "elastic/far_wakes.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/mutual_wakes.hpp"
#include "support/instruction_sets.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::elastic;

namespace {

struct Crowd {
    std::vector<Source> rods;
    double width, height;
};

Crowd crowd(std::size_t count, double width, double height, std::uint64_t seed = 91) {
    RandomStream random(seed);
    Crowd all{std::vector<Source>(count), width, height};
    for (Source& one : all.rods)
        one = {random.uniform(0.0, width), random.uniform(0.0, height), random.uniform(-4.0, 4.0)};
    return all;
}

struct Result {
    Sums sums;
    std::size_t done;
};

Result sums_of(const std::vector<Source>& rods, const Medium& medium, const MutualWakesOptions& options,
               bool polar) {
    Result result{Sums(rods.size()), 0};
    const MutualWakes wakes(medium, options);
    result.done = polar ? wakes.strain_and_polar(rods, result.sums.strain(), result.sums.polar())
                        : wakes.strain(rods, result.sums.strain());
    return result;
}

double largest_difference(const Sums& a, const Sums& b, int first, int last) {
    double largest = 0.0;
    for (int k = first; k < last; ++k)
        for (std::size_t i = 0; i < a.part[k].size(); ++i)
            largest = std::max(largest, std::abs(a.part[k][i] - b.part[k][i]));
    return largest;
}

/// The wake of a rod at the origin along x, at heat_lanes places on a circle: exactly, and what is left of it
/// without nodes of time steps h in sqrt(t).
double left_over(const Medium& medium, double distance, double eta, double h) {
    std::vector<double> x, y, cosine, sine;
    WakeFunctions heat{};
    const double end = 3.0 * std::sqrt(distance) + 15.0 * std::sqrt(1.0 + eta); // t - r > 7 sigma
    for (double root = h; root < end; root += h)
        take_node({root * root, 2.0 * root * h}, eta, 0.5 * distance, heat);
    for (std::size_t i = 0; i < heat_lanes; ++i) {
        const double angle = std::numbers::pi * static_cast<double>(i) / (heat_lanes - 1);
        x.push_back(distance * (cosine.emplace_back(std::cos(angle))));
        y.push_back(distance * (sine.emplace_back(std::sin(angle))));
    }
    Sums sums(heat_lanes);
    const Source source{0.0, 0.0, 0.0};
    WakeKernel(medium).strain_and_polar({&source, 1}, {x, y}, sums.strain(), sums.polar());
    double parts[all_parts][heat_lanes], largest = 0.0;
    parts_at(heat, Field({eta, 1.0}), 0.5 * distance, cosine.data(), sine.data(), parts);
    for (std::size_t k = 0; k < all_parts; ++k)
        for (std::size_t i = 0; i < heat_lanes; ++i)
            largest = std::max(largest, std::abs(sums.part[k][i] + parts[k][i]));
    return largest;
}

} // namespace

TEST_CASE("a wake is the integral of drifting heat") {
    // steps so short that the trapezoidal rule is exact at these distances (it converges as
    // exp(-(r/h)^(2/3)))
    for (const double eta : {0.0, 0.3, 1.0, 8.0, 20.0})
        for (const double distance : {2.0, 10.0, 60.0}) {
            const double h = std::min(0.25, 0.02 * distance / std::sqrt(1.0 + eta));
            CAPTURE(eta, distance);
            CHECK(left_over({eta, 1.0}, distance, eta, h) < 1e-9);             // what comes after the end
            CHECK(left_over({1.2 * eta + 0.2, 1.0}, distance, eta, h) > 1e-7); // another medium: it can fail
        }
}

TEST_CASE("near pairs lose what the nodes gave them") {
    for (const double eta : {0.0, 2.0})
        for (const double tolerance : {1e-3, 1e-9}) {
            const FarWakes far({eta, 1.0}, tolerance, tolerance, true);
            const Crowd all = crowd(4000, 150.0, 150.0);
            std::vector<KernelSource> rods;
            for (const Source& rod : all.rods)
                rods.push_back({rod.x, rod.y, std::cos(rod.heading), std::sin(rod.heading)});
            const FarWakes::QuadraturePlan plan = far.plan(rods);
            const NearHeat& heat = far.near_heat(plan);
            // just within the reach exact field and heat are one: nothing is left of them
            NearSources sources;
            sources.reserve(heat_lanes);
            for (std::size_t k = 0; k < heat_lanes; ++k) {
                const double angle = 0.7 * static_cast<double>(k), r = 0.999 * plan.reach;
                sources.add(
                    {r * std::cos(angle), r * std::sin(angle), std::cos(2.0 * angle), std::sin(2.0 * angle)},
                    1.0);
            }
            std::array<double, all_parts> sums{};
            const Field field({eta, 1.0});
            add_near(KernelInternals::constants(field), field, heat, sources, 0.0, 0.0, true, sums);
            CAPTURE(eta, tolerance, plan.reach, heat.powers.size());
            for (const double sum : sums)
                CHECK(std::abs(sum) < tolerance); // of eight wakes with a tenth of it each
            NearSources nearer = sources;
            for (double& x : nearer.x)
                x *= 0.3;
            sums = {};
            add_near(KernelInternals::constants(field), field, heat, nearer, 0.0, 0.0, true, sums);
            CHECK(std::abs(sums[0]) > tolerance); // else nothing is looked at
        }
}

TEST_CASE("sums with far wakes keep to their tolerances") {
    struct Case {
        Medium medium;
        Crowd crowd;
    };
    const Case cases[] = {{{0.0, 1.0}, crowd(4000, 150.0, 150.0)}, {{1.0, 3.0}, crowd(4000, 300.0, 500.0)},
                          {{8.0, 0.5}, crowd(4000, 200.0, 200.0)}, {{20.0, 1.0}, crowd(4000, 400.0, 400.0)},
                          {{0.4, 1.0}, crowd(3000, 3000.0, 40.0)}, // a strip
                          {{1.0, 2.0}, crowd(3000, 20.0, 20.0)},   // dense
                          {{1.0, 0.1}, crowd(3000, 900.0, 900.0)}};
    std::size_t far = 0; // ways that were not pair by pair
    for (const Case& one : cases)
        for (const bool polar : {false, true}) {
            if (!polar && one.medium.eta > 1.0)
                continue; // strains come with polar vectors, too
            const Sums exact = sums_of(one.crowd.rods, one.medium, {}, polar).sums;
            const std::size_t n = one.crowd.rods.size();
            for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
                const Result got =
                    sums_of(one.crowd.rods, one.medium,
                            {.strain_tolerance = tolerance, .polar_tolerance = tolerance}, polar);
                CAPTURE(one.medium.eta, one.medium.xi, one.crowd.width, tolerance, polar, got.done);
                CHECK(largest_difference(got.sums, exact, 0, strain_parts) <= tolerance);
                if (polar)
                    CHECK(largest_difference(got.sums, exact, strain_parts, all_parts) <= tolerance);
                far += got.done < n * (n - 1);
            }
        }
    CHECK(far > 13); // of 36, the strip and the dense crowd go pair by pair
}

TEST_CASE("crowds whose errors add up keep to their tolerances, too") {
    RandomStream random(7);
    const double side = std::sqrt(2000.0 / 3.9);
    Crowd alike = crowd(2000, side, side), clumps = crowd(2000, 45.0, 45.0), marching = clumps;
    Crowd dense = crowd(2000, side, side);
    for (Source& rod : alike.rods)
        rod.heading = 0.3;
    for (std::size_t i = 0; i < 2000; ++i) { // of 20, within 0.25 xi
        const Source& centre = clumps.rods[i / 20 * 20];
        clumps.rods[i] = {centre.x + random.uniform(0.001, 0.25), centre.y + random.uniform(0.001, 0.25),
                          clumps.rods[i].heading};
        marching.rods[i] = {clumps.rods[i].x, clumps.rods[i].y, 0.3};
    }
    int far = 0;
    for (const Crowd* all : {&alike, &clumps, &marching, &dense}) {
        const Sums exact = sums_of(all->rods, {1.0, 1.0}, {}, true).sums;
        for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
            const Result got = sums_of(all->rods, {1.0, 1.0},
                                       {.strain_tolerance = tolerance, .polar_tolerance = tolerance}, true);
            CAPTURE(all->width, all->rods[0].heading, tolerance, got.done);
            CHECK(largest_difference(got.sums, exact, 0, strain_parts) <= tolerance);
            CHECK(largest_difference(got.sums, exact, strain_parts, all_parts) <= tolerance);
            far += got.done < 2000 * 1999;
        }
    }
    CHECK(far > 5); // of 12: dense ones at tight tolerances go pair by pair
}

TEST_CASE("rods that nearly touch keep to a tight polar tolerance, though the strain's is wide") {
    Crowd all = crowd(4000, 150.0, 150.0);
    for (std::size_t i = 0; i < 40; i += 2) {
        all.rods[i + 1] = all.rods[i];
        all.rods[i + 1].x += 0.02 * static_cast<double>(1 + i % 5);
    }
    const Medium medium{1.0, 1.0};
    const Sums exact = sums_of(all.rods, medium, {}, true).sums;
    const Result got = sums_of(all.rods, medium, {.strain_tolerance = 1e30, .polar_tolerance = 1e-9}, true);
    CHECK(got.done < 4000 * 3999);
    CHECK(largest_difference(got.sums, exact, strain_parts, all_parts) <= 1e-9);
}

TEST_CASE("far wakes have the same bits for any number of threads and every instruction set", "[threads]") {
    const Crowd all = crowd(1200, 200.0, 150.0);
    MutualWakesOptions options{.strain_tolerance = 1e-4, .polar_tolerance = 1e-4};
    const Medium medium{0.5, 1.3};
    const Result first = sums_of(all.rods, medium, options, true);
    REQUIRE(first.done < 1200 * 1199);
    const auto same = [&] {
        const Result other = sums_of(all.rods, medium, options, true);
        for (int k = 0; k < all_parts; ++k)
            REQUIRE(other.sums.part[k] == first.sums.part[k]);
    };
    for (options.threads = 2; options.threads < 4; ++options.threads)
        same();
    for_each_instruction_set(same);
}

TEST_CASE("crowds denser than was measured, and near pairs that no polynomial tells, go pair by pair") {
    const FarWakes far({1.0, 1.0}, 1e-6, 1e-6, true);
    for (const double density : {3.9, 4.1}) {
        const std::size_t count = 100'000;
        const double side = std::sqrt(static_cast<double>(count) / density);
        std::vector<KernelSource> rods;
        for (const Source& rod : crowd(count, side, side).rods)
            rods.push_back({rod.x, rod.y, 1.0, 0.0});
        CHECK(std::isfinite(far.plan(rods).cost) == (density < 4.0));
    }
    const HeatNode node{4.0, 1.0};
    CHECK_FALSE(near_heat({&node, 1}, 1.0, 20.0, 1e-6, true).powers.empty());
    CHECK(near_heat({&node, 1}, 1.0, 20.0, 1e-30, true).powers.empty());
}

TEST_CASE("a single far tolerance, few rods and media out of range go pair by pair") {
    const Crowd all = crowd(2000, 80.0, 80.0);
    const std::size_t pairs = 2000 * 1999;
    CHECK(sums_of(all.rods, {1.0, 1.0}, {.strain_tolerance = 1e-3}, true).done == pairs);
    CHECK(sums_of(all.rods, {1.0, 1.0}, {.strain_tolerance = 1e-3}, false).done < pairs);
    for (const double eta : {-0.3, 21.0})
        CHECK(sums_of(all.rods, {eta, 1.0}, {.strain_tolerance = 1e-3}, false).done == pairs);
    const Crowd few = crowd(100, 20.0, 20.0), wide = crowd(600, 1e7, 1e7);
    CHECK(sums_of(few.rods, {1.0, 1.0}, {.strain_tolerance = 1e-3}, false).done == 100 * 99);
    CHECK(sums_of(wide.rods, {1.0, 1.0}, {.strain_tolerance = 1e-3}, false).done == 600 * 599);
    CHECK(sums_of(all.rods, {1.0, 1.0}, {.strain_tolerance = 1e-12}, false).done == pairs);
}

TEST_CASE("rods far from each other, in a lattice, have the sums of all pairs") {
    RandomStream random(92);
    std::vector<Source> rods;
    for (int k = 0; k < 4096; ++k)
        rods.push_back({40.0 * (k % 64), 40.0 * (k / 64), random.uniform(-4.0, 4.0)});
    const Medium medium{0.5, 1.0};
    const Result got = sums_of(rods, medium, {.strain_tolerance = 1e-3}, false);
    CHECK(largest_difference(got.sums, sums_of(rods, medium, {}, false).sums, 0, strain_parts) <= 1e-3);
}

TEST_CASE("rods at one place are refused among near pairs, too") {
    Crowd all = crowd(3000, 150.0, 150.0);
    all.rods[70] = all.rods[2000];
    CHECK_THROWS_AS(sums_of(all.rods, {1.0, 1.0}, {.strain_tolerance = 1e-3}, false), InputError);
}

TEST_CASE("the work grows hardly faster than the number of rods") {
    const FarWakes far({1.0, 1.0}, 1e-3, 0.0, false);
    std::vector<double> near, cost;             // of a rod
    for (const std::size_t n : {4000, 16000}) { // of one density
        const double side = 2.3 * std::sqrt(static_cast<double>(n));
        const Crowd all = crowd(n, side, side);
        const Result got = sums_of(all.rods, {1.0, 1.0}, {.strain_tolerance = 1e-3}, false);
        std::vector<KernelSource> rods;
        for (const Source& rod : all.rods)
            rods.push_back({rod.x, rod.y, std::cos(rod.heading), std::sin(rod.heading)});
        near.push_back(static_cast<double>(got.done) / static_cast<double>(n));
        cost.push_back(far.plan(rods).cost / static_cast<double>(n));
    }
    CHECK(cost[1] < 1.3 * cost[0]); // of all pairs 4
    CHECK(near[1] < 2.5 * near[0]); // another plan may reach twice as many
}

// --- Sums over all pairs of rods: the field's numbers, and bits that depend on nothing else

namespace {

std::vector<Source> random_rods(RandomStream& random, std::size_t rods, double side) {
    std::vector<Source> all(rods);
    for (Source& one : all)
        one = {random.uniform(0.0, side), random.uniform(0.0, side), random.uniform(-4.0, 4.0)};
    return all;
}

Result mutual(const std::vector<Source>& rods, const Medium& medium, const MutualWakesOptions& options = {}) {
    Result result{Sums(rods.size()), 0};
    result.done =
        MutualWakes(medium, options).strain_and_polar(rods, result.sums.strain(), result.sums.polar());
    return result;
}

/// By the field, one after the other.
Sums by_field(const std::vector<Source>& rods, const Medium& medium) {
    Sums sums(rods.size());
    const Field field(medium);
    for (std::size_t i = 0; i < rods.size(); ++i) {
        std::vector<Source> others = rods;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        const FieldValues f = superpose(field, others, rods[i].x, rods[i].y, {.strain = true, .polar = true});
        const double part[] = {f.strain.xx,   f.strain.xy,           f.strain.yy,          f.laplacian.x,
                               f.laplacian.y, f.gradient_of_trace.x, f.gradient_of_trace.y};
        for (int k = 0; k < 7; ++k)
            sums.part[k][i] = part[k];
    }
    return sums;
}

/// Largest difference of strains, by the norm.
double strain_difference(const Sums& a, const Sums& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.part[0].size(); ++i) {
        const double xx = a.part[0][i] - b.part[0][i], xy = a.part[1][i] - b.part[1][i],
                     yy = a.part[2][i] - b.part[2][i];
        largest = std::max(largest, std::sqrt(xx * xx + 2.0 * xy * xy + yy * yy));
    }
    return largest;
}

double polar_difference(const Sums& a, const Sums& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.part[0].size(); ++i)
        for (const int k : {3, 5})
            largest = std::max(largest,
                               std::hypot(a.part[k][i] - b.part[k][i], a.part[k + 1][i] - b.part[k + 1][i]));
    return largest;
}

double largest(const Sums& sums, int first, int last) {
    double value = 0.0;
    for (int k = first; k <= last; ++k)
        for (const double one : sums.part[k])
            value = std::max(value, std::abs(one));
    return value;
}

void require_same_bits(const Sums& a, const Sums& b) {
    for (std::size_t i = 0; i < a.part[0].size(); ++i)
        REQUIRE(a.bits(i) == b.bits(i));
}

} // namespace

TEST_CASE("sums over all pairs are those of the field, for any number of rods") {
    RandomStream random(71);
    const Medium medium{1.3, 2.0};
    // one tile, its edges, several tiles, a block and its edges, several blocks
    for (const std::size_t n : {1, 2, 3, 7, 8, 9, 15, 16, 17, 31, 40, 127, 128, 129, 300}) {
        const std::vector<Source> rods = random_rods(random, n, 4.0 * std::sqrt(static_cast<double>(n)));
        const Sums exact = by_field(rods, medium);
        CAPTURE(n);
        const Result full = mutual(rods, medium);
        CHECK(full.done == n * (n - 1));
        CHECK(strain_difference(full.sums, exact) <= 1e-13 * largest(exact, 0, 2)); // a kernel's bound
        CHECK(polar_difference(full.sums, exact) <= 1e-12 * largest(exact, 3, 6));
        const Sums fine = mutual(rods, medium, {.accuracy = Accuracy::fine}).sums;
        CHECK(strain_difference(fine, exact) <= 1e-7 * largest(exact, 0, 2)); // bounds of accuracy.hpp
        const Sums single = mutual(rods, medium, {.accuracy = Accuracy::single}).sums;
        CHECK(strain_difference(single, exact) <= 1e-4 * largest(exact, 0, 2));
        CHECK(polar_difference(single, exact) <= 1e-4 * largest(exact, 3, 6));
    }
    MutualWakes(medium).strain({}, {});
}

TEST_CASE("strains alone are those that come with polar vectors") {
    RandomStream random(72);
    const std::vector<Source> rods = random_rods(random, 150, 30.0);
    const Sums both = mutual(rods, {2.0, 1.0}).sums;
    Sums alone(rods.size());
    MutualWakes({2.0, 1.0}).strain(rods, alone.strain());
    for (int k = 0; k < 3; ++k)
        CHECK(alone.part[k] == both.part[k]);
}

TEST_CASE("all pairs have the same bits for any number of threads and every instruction set", "[threads]") {
    RandomStream random(73);
    std::vector<Source> rods = random_rods(random, 300, 1000.0);
    rods[200] = {0.0, 0.0, 2.0};
    rods[70] = {1e-15, 0.0, 1.0}; // a pair for the field
    const Medium medium{0.5, 1.0};
    for (const Accuracy accuracy : {Accuracy::full, Accuracy::fine, Accuracy::single}) {
        MutualWakesOptions options{.accuracy = accuracy};
        const Result first = mutual(rods, medium, options);
        options.threads = 3;
        require_same_bits(mutual(rods, medium, options).sums, first.sums);
        for_each_instruction_set([&] { require_same_bits(mutual(rods, medium, options).sums, first.sums); });
    }
}

TEST_CASE("all pairs beyond the kernel's range are the field's") {
    RandomStream random(74);
    const std::vector<Source> rods = random_rods(random, 20, 10.0);
    for (const double eta : {-0.5, 1e12}) { // eta < 0; nu r below the table
        const Sums exact = by_field(rods, {eta, 1.0});
        CHECK(strain_difference(mutual(rods, {eta, 1.0}).sums, exact) <= 1e-14 * largest(exact, 0, 2));
    }
}

TEST_CASE("all pairs refuse what is none") {
    const std::vector<Source> same{{1.0, 2.0, 0.0}, {3.0, 2.0, 0.0}, {1.0, 2.0, 1.0}};
    CHECK_THROWS_AS(mutual(same, {1.0, 1.0}), InputError);
    CHECK_THROWS_AS(mutual({{std::nan(""), 0.0, 0.0}, {1.0, 0.0, 0.0}}, {1.0, 1.0}), InputError);
    std::vector<double> two(2), three(3);
    CHECK_THROWS_WITH(MutualWakes({1.0, 1.0}).strain(same, {three, two, three}),
                      Catch::Contains("xy has 2 numbers for 3"));
    CHECK_THROWS_AS(MutualWakes({1.0, 1.0}, {.threads = 0}), InputError);
    CHECK_THROWS_AS(MutualWakes({1.0, 1.0}, {.strain_tolerance = -1.0}), InputError);
    CHECK_THROWS_AS(MutualWakes({-1.0, 1.0}), InputError);
}
