// Sums over all pairs of rods: the field's numbers, and bits that depend on nothing else.

#include "wake_samples.hpp"

#include "support/instruction_sets.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/elastic/mutual_wakes.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace rodwake;
using namespace rodwake::elastic;

namespace {

std::vector<Source> random_rods(RandomStream& random, std::size_t rods, double side) {
    std::vector<Source> all(rods);
    for (Source& one : all)
        one = {random.uniform(0.0, side), random.uniform(0.0, side), random.uniform(-4.0, 4.0)};
    return all;
}

struct Result {
    Sums sums;
    std::size_t done;
};

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
    std::vector<Source> rods = random_rods(random, 600, 1500.0);
    rods[300] = {0.0, 0.0, 2.0};
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
