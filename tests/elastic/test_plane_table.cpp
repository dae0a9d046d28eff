// The wake on the plane as a table: its error against the exact field, what is exact in it, symmetry.

#include "periodic_cases.hpp"
#include "stencil.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/periodic_table.hpp"
#include "rodwake/elastic/plane_table.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace rodwake;
using namespace rodwake::elastic;
using namespace rodwake::oracle;
using elastic::FieldRequest;
using elastic::FieldValues;
using elastic::Medium;
using elastic::PeriodicField;
using elastic::PeriodicTable;
using elastic::Source;
using elastic::Vector;

namespace {

std::shared_ptr<const PlaneTable> table_of(double eta, double tolerance) {
    return std::make_shared<const PlaneTable>(make_plane_table(eta, tolerance, 2));
}

double off(const Vector& a, const Vector& b) { return std::hypot(a.x - b.x, a.y - b.y); }
double off(const SymmetricTensor& a, const SymmetricTensor& b) {
    return std::sqrt(std::pow(a.xx - b.xx, 2) + 2.0 * std::pow(a.xy - b.xy, 2) + std::pow(a.yy - b.yy, 2));
}
double norm(const SymmetricTensor& t) { return off(t, {}); }

} // namespace

TEST_CASE("a table keeps its tolerance at points it was not made from") {
    for (const auto& [eta, tolerance] : {std::pair{0.3, 1e-3}, {30.0, 1e-4}}) {
        const auto table = table_of(eta, tolerance);
        CAPTURE(eta, tolerance);
        CHECK(table->strain_error <= tolerance);
        CHECK(table->gradient_error <= tolerance);
        const TableErrors others = plane_table_errors(*table, 50'000, 7, 2);
        CHECK(others.strain <= tolerance);
        CHECK(others.gradient <= tolerance);
        CHECK(others.strain > 1e-3 * tolerance); // it is a table, and the comparison sees it
    }
}

TEST_CASE("an error in a table's numbers is seen") {
    PlaneTable table = make_plane_table(1.0, 1e-3, 2);
    for (std::size_t i = 0; i < table.strain.coefficients.size(); ++i)
        table.strain.coefficients[i] *= 1.01;
    CHECK(plane_table_errors(table, 10'000, 7).strain > 5e-3);
}

TEST_CASE("polar vectors and gradients follow from the table, in any unit and on both sides") {
    constexpr double tolerance = 1e-6;
    const Medium medium{.eta = 1.7, .xi = 3.0};
    const auto field = table_field(table_of(medium.eta, tolerance), medium);
    const auto wake = field->wake(0.4);
    const elastic::Field exact(medium);
    constexpr FieldRequest all{
        .displacement = true, .strain = true, .polar = true, .dipole = true, .gradients = true};
    RandomStream random(3);
    for (int k = 0; k < 2000; ++k) {
        const double r = random.log_uniform(1e-3, 100.0), angle = random.uniform(-3.14, 3.14);
        const double x = r * std::cos(angle), y = r * std::sin(angle);
        const FieldValues a = wake->at(x, y, all), b = exact.at(x, y, all);
        const double slope = std::hypot(norm(b.strain_x), norm(b.strain_y));
        CHECK(off(a.strain, b.strain) <= tolerance * norm(b.strain));
        CHECK(std::hypot(off(a.strain_x, b.strain_x), off(a.strain_y, b.strain_y)) <= tolerance * slope);
        // each a sum of at most four components, sqrt(2) apart from the norm
        CHECK(off(a.laplacian, b.laplacian) <= 4.0 * tolerance * slope);
        CHECK(off(a.gradient_of_trace, b.gradient_of_trace) <= 4.0 * tolerance * slope);
        CHECK(a.displacement.x == b.displacement.x); // exact
        CHECK(a.dipole.y == b.dipole.y);
        // derivatives of polynomials of degree 5 on cells of 1/6 of the distance and less: d^2 times n
        const double bend = slope / std::min(r, medium.xi);
        CHECK(off(a.laplacian_x, b.laplacian_x) <= 300.0 * tolerance * bend);
        CHECK(off(a.gradient_of_trace_y, b.gradient_of_trace_y) <= 300.0 * tolerance * bend);
    }
}

TEST_CASE("the core and the far field are exact") {
    const Medium medium{.eta = 1.0, .xi = 2.0};
    const auto wake = table_field(table_of(1.0, 1e-2), medium)->wake(0.0);
    const elastic::Field exact(medium);
    for (const auto& [x, y] : {std::pair{1e-5, 2e-5}, {-1e-9, 0.0}, {-700.0, 3.0}, {1e6, -1.0}}) {
        const FieldValues a = wake->at(x, y, {.strain = true, .polar = true}),
                          b = exact.at(x, y, {.strain = true, .polar = true});
        CHECK(off(a.strain, b.strain) == 0.0);
        CHECK(off(a.laplacian, b.laplacian) == 0.0);
    }
    CHECK_THROWS_AS(wake->at(0.0, 0.0, {.strain = true}), InputError);
    CHECK_THROWS_AS(wake->at(std::nan(""), 0.0, {.strain = true}), InputError);
    CHECK_THROWS_AS(wake->at(1.0, std::numeric_limits<double>::infinity(), {.strain = true}), InputError);
}

TEST_CASE("a table is the same whatever the threads, and is made for one eta", "[threads]") {
    CHECK(make_plane_table(0.5, 1e-2, 1) == make_plane_table(0.5, 1e-2, 3));
    CHECK_THROWS_WITH(table_field(table_of(0.5, 1e-2), {.eta = 0.6, .xi = 1.0}), Catch::Contains("eta"));
    CHECK_THROWS_WITH(make_plane_table(1.0, 0.0), Catch::Contains("tolerance"));
    CHECK_THROWS_AS(make_plane_table(-2.0, 1e-3), InputError);
}

// --- The table of the periodic field against the field itself

namespace {

constexpr double box = 3.0;

Medium medium_of(double ratio, double eta) { return {.eta = eta, .xi = box / ratio}; }

/// Components and place from the rod's frame to the lab's; plain quantities.
FieldValues to_lab(const FieldValues& f, double heading) {
    const double c = std::cos(heading), s = std::sin(heading);
    FieldValues g = f;
    g.displacement = turned(f.displacement, c, s);
    g.strain = turned(f.strain, c, s);
    g.laplacian = turned(f.laplacian, c, s);
    g.gradient_of_trace = turned(f.gradient_of_trace, c, s);
    g.dipole = turned(f.dipole, c, s);
    return g;
}

/// A place within two cells about a source somewhere, and any heading.
struct Case {
    Source source;
    double x, y;

    explicit Case(RandomStream& random)
        : source{random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0), random.uniform(-20.0, 20.0)},
          x(source.x + random.uniform(-4.0, 4.0)), y(source.y + random.uniform(-4.0, 4.0)) {}

    Vector from_rod() const { return to_rod(source.heading, x - source.x, y - source.y); }
    double distance() const { // from the nearest image
        return std::hypot(std::remainder(x - source.x, box), std::remainder(y - source.y, box));
    }
};

} // namespace

TEST_CASE("the table of the periodic field is the field within its tolerance") {
    for (const auto& [ratio, eta, tolerance] : {std::array{1e-3, 1.3, 1e-8},
                                                {0.02, 30.0, 1e-8},
                                                {3.0, 1.3, 1e-10},
                                                {8.0, 0.01, 1e-8},
                                                {12.0, -0.3, 1e-6},
                                                {20.0, 1.3, 1e-5}}) {
        const PeriodicTable table(medium_of(ratio, eta), box, tolerance, 2);
        CAPTURE(ratio, eta, tolerance, table.error());
        CHECK(table.error() <= tolerance);
        CHECK(table.error() > 1e-4 * tolerance); // measured at all
        CHECK(table.bytes() < PeriodicTable::memory_limit);
        RandomStream random(121);
        double largest = 0.0;
        for (int k = 0; k < 200; ++k) {
            const Case at(random);
            const PeriodicField field(table.medium(), box, at.source.heading);
            const Vector place = at.from_rod();
            const FieldValues exact = to_lab(field.at(place.x, place.y, plain), at.source.heading);
            const Norms scale = largest_at(field, at.distance());
            largest =
                std::max(largest, worst(distances(table.at(at.source, at.x, at.y, plain), exact), scale));
        }
        CHECK(largest < 3.0 * tolerance); // a sample of 640 places may miss the worst
    }
}

TEST_CASE("gradients of the table are those of the field") {
    for (const auto& [ratio, eta] : {std::pair{0.01, 1.3}, {4.0, 10.0}, {15.0, 0.5}}) {
        const PeriodicTable table(medium_of(ratio, eta), box);
        RandomStream random(122);
        for (int k = 0; k < 60; ++k) {
            const Case at(random);
            const Vector place = at.from_rod();
            const double c = std::cos(at.source.heading), s = std::sin(at.source.heading);
            const FieldRequest request{.strain = true, .polar = true, .gradients = true};
            const PeriodicField field(table.medium(), box, at.source.heading);
            const FieldValues got = table.at(at.source, at.x, at.y, request),
                              own = field.at(place.x, place.y, request);
            const auto strain_x = turned(own.strain_x, c, s), strain_y = turned(own.strain_y, c, s);
            const auto lap_x = turned(own.laplacian_x, c, s), lap_y = turned(own.laplacian_y, c, s);
            const Norms scale = largest_at(field, at.distance());
            CAPTURE(ratio, eta, k, place.x, place.y);
            // 1e-8 of the strain over pieces of L/6, times the square of the degree, 64, at their ends
            const double strain = 1e-6 * scale[1] / box, lap = 1e-6 * scale[2] / box;
            CHECK(std::abs(got.strain_x.xy - (c * strain_x.xy - s * strain_y.xy)) < strain);
            CHECK(std::abs(got.strain_y.xx - (s * strain_x.xx + c * strain_y.xx)) < strain);
            CHECK(std::abs(got.laplacian_x.y - (c * lap_x.y - s * lap_y.y)) < lap);
            CHECK(std::abs(got.laplacian_y.x - (s * lap_x.x + c * lap_y.x)) < lap);
            CHECK(got.strain.xy == table.at(at.source, at.x, at.y, {.strain = true}).strain.xy);
        }
    }
}

TEST_CASE("the derivative of the table by heading is that of the field") {
    for (const auto& [ratio, eta] : {std::pair{0.01, 1.3}, {4.0, 10.0}, {15.0, 0.5}}) {
        const PeriodicTable table(medium_of(ratio, eta), box);
        RandomStream random(123);
        for (int k = 0; k < 60; ++k) {
            const Case at(random);
            const auto field_at = [&](double h) {
                Case changed = at;
                changed.source.heading += h;
                const Vector place = changed.from_rod();
                return to_lab(
                    PeriodicField(table.medium(), box, changed.source.heading).at(place.x, place.y, plain),
                    changed.source.heading);
            };
            const FieldValues got = table.heading_derivative(at.source, at.x, at.y, plain);
            const PeriodicField field(table.medium(), box, at.source.heading);
            const double rate = std::max(1.0, ratio / pi); // of the field's change by heading
            Norms scale = largest_at(field, at.distance());
            for (double& one : scale)
                one *= rate;
            CAPTURE(ratio, eta, k, at.source.heading);
            // 1e-8 over pieces of an eighth turn and less, times the square of the degree, 121, at their ends
            CHECK(worst(distances(got, field_difference(field_at, 0.01 / rate)), scale) < 1e-6);
            CHECK(norms(got)[1] > 0.0);
        }
    }
}

TEST_CASE("the table knows what the images do to their own rod") {
    for (const double ratio : {0.01, 5.0, 15.0}) {
        const PeriodicTable table(medium_of(ratio, 2.0), box);
        for (const double heading : {0.0, 0.3, pi / 4, -0.2, 1.2, 3.0, -2.2, 40.0}) {
            const PeriodicField field(table.medium(), box, heading);
            const FieldValues own = table.self_image_field(heading, plain);
            const Norms scale = largest_at(field, 0.5 * box);
            CAPTURE(ratio, heading);
            CHECK(worst(distances(own, to_lab(field.self_image_field(plain), heading)), scale) < 1e-8);
            const FieldValues f = field.self_image_field(plain), turn = field.own_place_by_heading(plain);
            // in the lab's components the field turns too
            FieldValues sum = turn;
            sum.strain.xx -= 2.0 * f.strain.xy;
            sum.strain.xy += f.strain.xx - f.strain.yy;
            sum.strain.yy += 2.0 * f.strain.xy;
            const FieldValues exact = to_lab(sum, heading), got = table.own_place_by_heading(heading, plain);
            CHECK(distances(got, exact)[1] < 1e-6 * scale[1] * std::max(1.0, ratio / pi));
            const FieldValues gradients =
                table.self_image_field(heading, {.strain = true, .gradients = true});
            CHECK(gradients.strain.xy == Approx(own.strain.xy).epsilon(0).margin(1e-13 * scale[1]));
            const auto along = field.self_image_field({.strain = true, .gradients = true});
            const double c = std::cos(heading), s = std::sin(heading);
            CHECK(std::abs(gradients.strain_x.xy -
                           (c * turned(along.strain_x, c, s).xy - s * turned(along.strain_y, c, s).xy)) <
                  1e-6 * scale[1] / box);
        }
    }
}

TEST_CASE("the table is the same for any number of threads", "[threads]") {
    const PeriodicTable one(medium_of(10.0, 1.3), box, 1e-6, 1), two(medium_of(10.0, 1.3), box, 1e-6, 2);
    RandomStream random(124);
    for (int k = 0; k < 50; ++k) {
        const Case at(random);
        CHECK(one.at(at.source, at.x, at.y, plain).strain.xy ==
              two.at(at.source, at.x, at.y, plain).strain.xy);
    }
    CHECK(one.error() == two.error());
}

TEST_CASE("only what is asked of a table is evaluated") {
    const PeriodicTable table(medium_of(2.0, 1.3), box, 1e-6);
    const FieldValues all = table.at({}, 0.4, 0.3, plain), one = table.at({}, 0.4, 0.3, {.polar = true});
    CHECK(one.laplacian.x == all.laplacian.x);
    CHECK(std::isnan(one.strain.xx));
    CHECK(std::isnan(one.strain_x.xx));
    CHECK(std::isnan(table.heading_derivative({}, 0.4, 0.3, {.strain = true}).displacement.x));
    CHECK(std::isnan(table.self_image_field(0.3, {.strain = true}).dipole.y));
}

TEST_CASE("bad tables and places are errors") {
    const double nan = std::nan("");
    CHECK_THROWS_WITH(PeriodicTable({}, 1000.0), Catch::Contains("MB"));
    CHECK_THROWS_WITH(PeriodicTable({}, 1.0, 1e-12), Catch::Contains("tolerance"));
    CHECK_THROWS_WITH(PeriodicTable({}, 1.0, nan), Catch::Contains("tolerance"));
    CHECK_THROWS_WITH(PeriodicTable({}, -1.0), Catch::Contains("box ="));
    CHECK_THROWS_AS(PeriodicTable({.eta = -2.0, .xi = 1.0}, 1.0), InputError);
    const PeriodicTable table(medium_of(2.0, 1.3), box, 1e-6);
    CHECK_THROWS_AS(table.at({0.5, 0.5, 0.1}, 0.5, 0.5, {.strain = true}), InputError);
    CHECK_THROWS_AS(table.at({0.0, 0.0, 0.1}, box, -2.0 * box, {.strain = true}), InputError);
    CHECK_THROWS_WITH(table.at({0.0, 0.0, nan}, 1.0, 1.0, {.strain = true}), Catch::Contains("finite"));
    CHECK_THROWS_WITH(table.at({}, nan, 1.0, {.strain = true}), Catch::Contains("finite"));
    CHECK_THROWS_WITH(table.self_image_field(nan, {.strain = true}), Catch::Contains("finite"));
    CHECK_THROWS_WITH(table.heading_derivative({}, 0.1, 0.1, {.gradients = true}),
                      Catch::Contains("gradients"));
    CHECK_THROWS_WITH(table.own_place_by_heading(0.1, {.gradients = true}), Catch::Contains("gradients"));
}
