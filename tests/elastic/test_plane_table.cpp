// The wake on the plane as a table: its error against the exact field, what is exact in it, symmetry.

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/plane_table.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace rodwake;
using namespace rodwake::elastic;

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
    const Field exact(medium);
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
    const Field exact(medium);
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
