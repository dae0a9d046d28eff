// The batched kernels: the field's numbers, and bits that depend on nothing else.

#include "error_norm.hpp"
#include "reference_table.hpp"
#include "wake_samples.hpp"

#include "elastic/geometry.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/elastic/wake_bound.hpp"
#include "support/instruction_sets.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>
#include <string>

using namespace rodwake;
using namespace rodwake::elastic;

namespace {

/// Errors of strain, lap U and grad div U, each relative to its norm.
using Errors = std::array<double, 3>;

double relative(std::initializer_list<double> got, std::initializer_list<double> exact) {
    double difference = 0.0, norm = 0.0;
    for (auto g = got.begin(), e = exact.begin(); g != got.end(); ++g, ++e) {
        difference += (*g - *e) * (*g - *e);
        norm += *e * *e;
    }
    return difference == 0.0 ? 0.0 : std::sqrt(difference / norm);
}

/// By the closed form: Field::at itself takes the kernels' algorithm where it can.
FieldValues lab_potentials(const Field& field, const Source& source, double x, double y) {
    const double cosine = std::cos(source.heading), sine = std::sin(source.heading);
    const Vector at = turned(Vector{x - source.x, y - source.y}, cosine, -sine);
    FieldValues f = FieldInternals::by_potentials(field, at.x, at.y, {.strain = true, .polar = true});
    f.strain = turned(f.strain, cosine, sine);
    f.laplacian = turned(f.laplacian, cosine, sine);
    f.gradient_of_trace = turned(f.gradient_of_trace, cosine, sine);
    return f;
}

Errors errors_at(const Medium& medium, const Source& source, double x, double y,
                 Accuracy accuracy = Accuracy::full) {
    const Sums got = Batch{{source}, {x}, {y}}.sums(medium, accuracy);
    const FieldValues exact = lab_potentials(Field(medium), source, x, y);
    const auto of = [&](int part) { return got.part[part][0]; };
    const SymmetricTensor& e = exact.strain;
    const double root = std::sqrt(2.0); // xy stands twice in the norm
    return {relative({of(0), root * of(1), of(2)}, {e.xx, root * e.xy, e.yy}),
            relative({of(3), of(4)}, {exact.laplacian.x, exact.laplacian.y}),
            relative({of(5), of(6)}, {exact.gradient_of_trace.x, exact.gradient_of_trace.y})};
}

/// All round the rod and close to its axis on both sides.
double random_angle(RandomStream& random, int kind) {
    const double small = random.uniform(-1.0, 1.0) * random.log_uniform(1e-9, 1.0);
    return kind % 3 == 0 ? random.uniform(-3.2, 3.2) : kind % 3 == 1 ? small : std::numbers::pi + small;
}

struct Spread {
    Errors median, of_99, largest;
};

/// eta in [0.1, 100], r/xi in [0.005, 80]. Points ahead at which a value is below 1e-12 of its unit are left
/// out in single precision (accuracy.hpp).
Spread errors_at_random(Accuracy accuracy, int points) {
    RandomStream random(81);
    std::array<std::vector<double>, 3> all;
    while (all[0].size() < static_cast<std::size_t>(points)) {
        const int k = static_cast<int>(all[0].size());
        const Medium medium{random.log_uniform(0.1, 100.0), random.log_uniform(0.1, 10.0)};
        const double r = medium.xi * random.log_uniform(0.005, 80.0), angle = random_angle(random, k);
        const double x = r * std::cos(angle), y = r * std::sin(angle);
        if (accuracy == Accuracy::single && medium.nu() * (r + x) > 2.0 * medium.xi * 39.0)
            continue;
        const Errors e = errors_at(medium, {}, x, y, accuracy);
        for (int q = 0; q < 3; ++q)
            all[q].push_back(e[q]);
    }
    Spread spread{};
    for (int q = 0; q < 3; ++q) {
        std::sort(all[q].begin(), all[q].end());
        spread.median[q] = all[q][all[q].size() / 2];
        spread.of_99[q] = all[q][all[q].size() * 99 / 100];
        spread.largest[q] = all[q].back();
    }
    return spread;
}

} // namespace

TEST_CASE("the kernel agrees with the field at random points") {
    const Spread spread = errors_at_random(Accuracy::full, 20000);
    CHECK(spread.of_99[0] < 1e-14); // 4.6e-15 in 99 of 100 (studies/reports/elastic.md)
    CHECK(spread.largest[0] <
          1.5e-13); // 7.9e-14 in 200000: eta near 100 beside the rod, where parts of 1/s cancel
    CHECK(spread.largest[1] < 1e-11); // near the curve ahead on which lap U vanishes
    CHECK(spread.largest[2] < 2e-12); // r/xi = 80 on the wake axis
}

TEST_CASE("fine and single accuracy are what their header says") {
    const Spread fine = errors_at_random(Accuracy::fine, 20000),
                 single = errors_at_random(Accuracy::single, 20000);
    CHECK(fine.of_99[0] < 2e-9); // bounds of accuracy.hpp
    CHECK(fine.largest[0] < 1e-7);
    CHECK(fine.largest[0] > 1e-10); // else the full table was used
    CHECK(single.of_99[0] < 3e-5);
    CHECK(single.largest[0] < 1e-3);
    CHECK(single.largest[0] > 1e-6);
}

TEST_CASE("errors of the accuracies, many points", "[.][long]") {
    for (const Accuracy accuracy : {Accuracy::full, Accuracy::fine, Accuracy::single}) {
        const Spread spread = errors_at_random(accuracy, 200000);
        for (int q = 0; q < 3; ++q)
            std::printf("accuracy %d, quantity %d: median %.1e, 99 %% %.1e, largest %.1e\n",
                        static_cast<int>(accuracy), q, spread.median[q], spread.of_99[q], spread.largest[q]);
        CHECK(spread.largest[0] < (accuracy == Accuracy::full   ? 1.5e-13
                                   : accuracy == Accuracy::fine ? 1e-7
                                                                : 1e-3));
    }
}

TEST_CASE("the faster route of the field agrees with the closed form, and is taken") {
    RandomStream random(88);
    double worst = 0.0, worst_99 = 0.0;
    int other_bits = 0;
    std::vector<double> all;
    for (int k = 0; k < 20000; ++k) {
        const Field field({random.log_uniform(1e-3, 20.0), random.log_uniform(0.1, 10.0)});
        const double r = field.medium().xi * random.log_uniform(1e-6, 300.0), angle = random_angle(random, k);
        const double x = r * std::cos(angle), y = r * std::sin(angle), root = std::sqrt(2.0);
        const SymmetricTensor got = field.strain(x, y),
                              exact = FieldInternals::by_potentials(field, x, y, {.strain = true}).strain;
        all.push_back(relative({got.xx, root * got.xy, got.yy}, {exact.xx, root * exact.xy, exact.yy}));
        worst = std::max(worst, all.back());
        other_bits += all.back() > 0.0;
    }
    std::nth_element(all.begin(), all.begin() + 19800, all.end());
    worst_99 = all[19800];
    CAPTURE(worst, worst_99);
    CHECK(worst < 1e-12); // what field.hpp promises
    CHECK(worst_99 < 2e-14);
    CHECK(other_bits > 5000);
}

TEST_CASE("a strain has the same bits whatever is asked for beside it") {
    RandomStream random(89);
    for (int k = 0; k < 3000; ++k) {
        const Field field({random.log_uniform(0.05, 20.0), 1.0});
        const double r = random.log_uniform(1e-7, 300.0), angle = random_angle(random, k);
        const double x = r * std::cos(angle), y = r * std::sin(angle);
        const SymmetricTensor alone = field.strain(x, y);
        for (const FieldRequest request : {FieldRequest{.strain = true},
                                           {.strain = true, .polar = true},
                                           {.displacement = true, .strain = true},
                                           {.strain = true, .polar = true, .gradients = true}}) {
            const FieldValues f = field.at(x, y, request);
            CAPTURE(field.medium().eta, x, y);
            REQUIRE(std::array{f.strain.xx, f.strain.xy, f.strain.yy} ==
                    std::array{alone.xx, alone.xy, alone.yy});
            REQUIRE(std::isnan(f.laplacian.x) != request.polar);
            REQUIRE(std::isnan(f.displacement.x) != request.displacement);
            REQUIRE(std::isnan(f.dipole.x));
        }
        const FieldValues polar = field.at(x, y, {.polar = true}), dipole = field.at(x, y, {.dipole = true});
        REQUIRE(std::isnan(polar.strain.xx));
        REQUIRE(polar.laplacian.x == field.at(x, y, {.strain = true, .polar = true}).laplacian.x);
        REQUIRE(std::isnan(dipole.strain.xx));
        REQUIRE(dipole.dipole.x == -alone.yy);
    }
}

TEST_CASE("the kernel agrees with the reference table where its range ends and beyond") {
    double worst = 0.0;
    int rows = 0;
    for (const auto& row : oracle::reference_table(std::string(RODWAKE_TEST_DATA) + "/elastic_field.csv")) {
        const auto exact = components(row, oracle::Quantity::strain);
        if (oracle::norm(exact) < 1e-280)
            continue;
        FieldValues got{};
        got.strain = WakeKernel({row.point.eta, row.point.xi}).strain({}, row.point.x, row.point.y);
        worst = std::max(worst, oracle::relative_error(components(got, oracle::Quantity::strain), exact));
        ++rows;
    }
    CHECK(rows > 250);
    CHECK(worst < 1e-12); // eta up to 1e4 and exponents up to 200
}

TEST_CASE("the kernel is finite wherever the field is") {
    RandomStream random(82);
    for (int k = 0; k < 20000; ++k) {
        const Medium medium{k % 7 == 0   ? 0.0
                            : k % 7 == 1 ? -0.5
                                         : random.log_uniform(1e-9, 1e6),
                            random.log_uniform(1e-3, 1e3)};
        const double r = medium.xi * random.log_uniform(1e-20, 1e12), angle = random_angle(random, k);
        const Sums got = Batch{{{}}, {r * std::cos(angle)}, {r * std::sin(angle)}}.sums(medium);
        CAPTURE(medium.eta, medium.xi, r, angle);
        for (const auto& part : got.part)
            REQUIRE(std::isfinite(part[0]));
    }
}

TEST_CASE("what the kernel cannot do is the field's own") {
    for (const auto& [eta, r] : {std::pair{-0.5, 1.0}, {1.0, 1e-14}, {1.0, 1e7}, {1e12, 1e-3}}) {
        const Errors e = errors_at({eta, 1.0}, {0.0, 0.0, 2.0}, -r, 0.1 * r);
        CAPTURE(eta, r);
        CHECK(e[0] == 0.0);
        CHECK(e[1] == 0.0);
    }
}

TEST_CASE("eta near 0 and tiny distances keep their digits") {
    RandomStream random(83);
    for (int k = 0; k < 3000; ++k) {
        const double eta = k % 3 == 0 ? 0.0 : random.log_uniform(1e-14, 0.1), angle = random_angle(random, k);
        const double r = random.log_uniform(1e-9, 10.0);
        CAPTURE(eta, r, angle);
        CHECK(errors_at({eta, 1.0}, {}, r * std::cos(angle), r * std::sin(angle))[0] < 1e-13);
    }
}

TEST_CASE("sources anywhere are added in their order") {
    RandomStream random(84);
    const Medium medium{1.3, 2.0};
    const Batch batch = random_batch(random, 40, 30, 20.0);
    const Sums got = batch.sums(medium);
    for (std::size_t i = 0; i < batch.x.size(); ++i) {
        const FieldValues exact =
            superpose(Field(medium), batch.sources, batch.x[i], batch.y[i], {.strain = true, .polar = true});
        CHECK(got.part[0][i] == Approx(exact.strain.xx).epsilon(1e-11));
        CHECK(got.part[1][i] == Approx(exact.strain.xy).epsilon(1e-11));
        CHECK(got.part[2][i] == Approx(exact.strain.yy).epsilon(1e-11));
        CHECK(got.part[4][i] == Approx(exact.laplacian.y).epsilon(1e-10));
        CHECK(got.part[5][i] == Approx(exact.gradient_of_trace.x).epsilon(1e-10));
    }
}

TEST_CASE("a target's bits do not depend on the others") {
    RandomStream random(85);
    const Medium medium{2.0, 1.0};
    for (std::size_t n = 1; n <= 17; ++n) {
        const Batch batch = random_batch(random, 3, n, 4.0);
        const Sums together = batch.sums(medium);
        for (std::size_t i = 0; i < n; ++i) {
            const Sums alone = Batch{batch.sources, {batch.x[i]}, {batch.y[i]}}.sums(medium);
            REQUIRE(together.bits(i) == alone.bits(0));
        }
        const SymmetricTensor one = WakeKernel(medium).strain(batch.sources[0], batch.x[0], batch.y[0]);
        REQUIRE(Batch{{batch.sources[0]}, batch.x, batch.y}.sums(medium).part[1][0] == one.xy);
    }
}

TEST_CASE("every instruction set gives the same bits") {
    RandomStream random(86);
    Batch batch = random_batch(random, 5, 203, 6.0);
    batch.x[7] = batch.sources[0].x + 1e-15; // one lane for the field
    batch.y[7] = batch.sources[0].y;
    const Medium medium{5.0, 0.7};
    const Sums first = batch.sums(medium), fine = batch.sums(medium, Accuracy::fine),
               single = batch.sums(medium, Accuracy::single);
    const Field field(medium);
    std::vector<SymmetricTensor> alone;
    for (std::size_t i = 0; i < batch.x.size(); ++i)
        alone.push_back(field.strain(batch.x[i], batch.y[i]));
    std::set<std::string> names;
    for_each_instruction_set([&] {
        names.insert(wake_kernel_target());
        const Sums again = batch.sums(medium), fine_again = batch.sums(medium, Accuracy::fine),
                   single_again = batch.sums(medium, Accuracy::single);
        for (std::size_t i = 0; i < batch.x.size(); ++i) {
            REQUIRE(again.bits(i) == first.bits(i));
            REQUIRE(fine_again.bits(i) == fine.bits(i));
            REQUIRE(single_again.bits(i) == single.bits(i));
            const SymmetricTensor strain = field.strain(batch.x[i], batch.y[i]);
            REQUIRE(std::array{strain.xx, strain.xy, strain.yy} ==
                    std::array{alone[i].xx, alone[i].xy, alone[i].yy});
        }
    });
    CHECK(names.size() > 1); // else nothing was compared
}

TEST_CASE("the kernel refuses targets at a source and spans of unlike lengths") {
    const WakeKernel kernel({1.0, 1.0});
    CHECK_THROWS_AS(kernel.strain({1.0, 2.0, 0.0}, 1.0, 2.0), InputError);
    CHECK_THROWS_AS(kernel.strain({}, std::nan(""), 2.0), InputError);
    std::vector<double> two(2), three(3);
    const Source source;
    CHECK_THROWS_WITH(kernel.strain({&source, 1}, {three, three}, {three, two, three}),
                      Catch::Contains("xy has 2 numbers for 3 targets"));
    CHECK_THROWS_AS(WakeKernel({-2.0, 1.0}), InputError);
}

// --- Bounds of a rod's field: never below it, and not idle

namespace {

struct Norms {
    double strain, polar;
};

Norms norms_at(const Medium& medium, double x, double y) {
    const FieldValues f = Field(medium).at(x, y, {.strain = true, .polar = true});
    const SymmetricTensor& e = f.strain;
    return {std::sqrt(e.xx * e.xx + 2.0 * e.xy * e.xy + e.yy * e.yy),
            std::max(std::hypot(f.laplacian.x, f.laplacian.y),
                     std::hypot(f.gradient_of_trace.x, f.gradient_of_trace.y))};
}

/// r + x, by y^2/(r - x) behind.
double ahead(double r, double x, double y) { return x > 0.0 ? r + x : y * y / (r - x); }

} // namespace

TEST_CASE("no field is above its bound, there or nearer to the rod and its wake") {
    RandomStream random(51);
    for (int k = 0; k < 60000; ++k) {
        const Medium medium{k % 5 == 0 ? random.uniform(-0.9, 0.0) : random.log_uniform(1e-3, 1e3),
                            random.log_uniform(0.1, 10.0)};
        const double r = medium.xi * random.log_uniform(1e-3, 1e4);
        const double angle =
            k % 2 == 0 ? random.uniform(-3.2, 3.2)
                       : std::numbers::pi + random.uniform(-1.0, 1.0) * random.log_uniform(1e-6, 1.0);
        const double x = r * std::cos(angle), y = r * std::sin(angle), w = ahead(r, x, y);
        const Norms norms = norms_at(medium, x, y);
        const WakeBound bound(medium);
        CAPTURE(medium.eta, medium.xi, r, angle);
        REQUIRE(norms.strain <= bound.strain(r, w));
        REQUIRE(norms.polar <= bound.polar(r, w));
        const double r0 = r * random.uniform(0.01, 1.0), w0 = w * random.uniform(0.0, 1.0);
        REQUIRE(bound.strain(r0, w0) >= bound.strain(r, w)); // falls with both
        REQUIRE(bound.polar(r0, w0) >= bound.polar(r, w));
    }
}

TEST_CASE("far away the bounds are within a factor of the field") {
    for (const double eta : {0.3, 1.0, 10.0})
        for (const double r : {20.0, 200.0, 2000.0}) {
            const Medium medium{eta, 1.0};
            double strain = 0.0, polar = 0.0; // largest of a circle
            for (int k = 0; k < 20000; ++k) {
                const double angle = std::numbers::pi * (1.0 - 1e-6 * std::pow(1e6, k / 20000.0));
                const Norms norms = norms_at(medium, r * std::cos(angle), r * std::sin(angle));
                strain = std::max(strain, norms.strain);
                polar = std::max(polar, norms.polar);
            }
            CAPTURE(eta, r);
            CHECK(WakeBound(medium).strain(r, 0.0) < 12.0 * strain);
            CHECK(WakeBound(medium).polar(r, 0.0) < 12.0 * polar);
        }
}

TEST_CASE("ahead the bounds decay as the field does") {
    const Medium medium{1.0, 1.0};
    const double near = WakeBound(medium).strain(20.0, 40.0) / norms_at(medium, 20.0, 0.0).strain,
                 far = WakeBound(medium).strain(200.0, 400.0) / norms_at(medium, 200.0, 0.0).strain;
    CHECK(far < 12.0);
    CHECK(near < 12.0); // without the exponent it would be 1e4 and 1e43
}

TEST_CASE("bounds refuse an illegal medium") { CHECK_THROWS_AS(WakeBound({-1.0, 1.0}), InputError); }
