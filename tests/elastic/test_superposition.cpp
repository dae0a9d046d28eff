// Rods anywhere in the plane: the rod-frame field turned, and summed.

#include "error_norm.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/field.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::elastic;
using oracle::Quantity;
using oracle::Real;

namespace {

constexpr FieldRequest plain{.displacement = true, .strain = true, .polar = true, .dipole = true};

/// S v or S t S^T written out as matrix products, in the order of oracle::components.
std::vector<Real> turned_exactly(const std::vector<Real>& v, double heading) {
    const Real c = cos(Real(heading)), s = sin(Real(heading)), S[2][2] = {{c, -s}, {s, c}};
    std::vector<Real> out(v.size(), Real(0));
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 2; ++k) {
            if (v.size() == 2)
                out[i] += S[i][k] * v[k];
            else
                for (std::size_t j = 0; j < 2; ++j)
                    for (std::size_t l = 0; l < 2; ++l)
                        out[2 * i + j] += S[i][k] * S[j][l] * v[2 * k + l];
        }
    return out;
}

} // namespace

TEST_CASE("a turned rod's field is the oracle's, turned") {
    RandomStream random(91);
    for (int k = 0; k < 60; ++k) {
        const Medium medium{.eta = random.log_uniform(0.1, 10.0), .xi = 1.0};
        const Source source{random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(-7.0, 7.0)};
        const double x = random.uniform(-2.0, 2.0), y = random.uniform(-2.0, 2.0);
        const double c = std::cos(source.heading), s = std::sin(source.heading);
        const FieldValues lab =
            lab_field(Field(medium), source, source.x + c * x - s * y, source.y + s * x + c * y, plain);
        const oracle::Field exact({x, y, medium.xi, medium.eta});
        for (int q = 0; q < oracle::plain_quantities; ++q) {
            const auto quantity = static_cast<Quantity>(q);
            const auto truth = turned_exactly(oracle::components(exact, quantity), source.heading);
            CAPTURE(oracle::name(quantity), x, y, source.heading);
            // The offset carries the rounding of coordinates up to 6, 1e-15, over r, times the steepness (two
            // powers).
            CHECK(oracle::relative_error(oracle::components(lab, quantity), truth) <
                  2e-14 / std::hypot(x, y));
        }
    }
}

TEST_CASE("turning the wrong way is seen") {
    const Field field({.eta = 1.0, .xi = 1.0});
    const FieldValues lab = lab_field(field, {0.0, 0.0, 0.3}, 1.0, 0.5, plain);
    const oracle::Field exact({1.0, 0.5, 1.0, 1.0});
    const auto truth = turned_exactly(oracle::components(exact, Quantity::strain), -0.3);
    CHECK(oracle::relative_error(oracle::components(lab, Quantity::strain), truth) >
          1e-2); // of order the angle
}

TEST_CASE("a quarter turn swaps the axes") {
    const Vector v = turned(Vector{1.0, 2.0}, 0.0, 1.0);
    CHECK((v.x == -2.0 && v.y == 1.0));
    const SymmetricTensor t = turned(SymmetricTensor{1.0, 2.0, 3.0}, 0.0, 1.0);
    CHECK((t.xx == 3.0 && t.xy == -2.0 && t.yy == 1.0));
}

TEST_CASE("fields add up, in order") {
    const Field field({.eta = 1.3, .xi = 2.0});
    const Source sources[] = {{0.0, 0.0, 0.4}, {1.0, -2.0, 2.0}, {-3.0, 0.5, -1.0}};
    FieldValues sum;
    for (const Source& source : sources) {
        const FieldValues one = lab_field(field, source, 0.7, 0.9, plain);
        sum.displacement.x += one.displacement.x;
        sum.strain.xy += one.strain.xy;
        sum.laplacian.y += one.laplacian.y;
        sum.gradient_of_trace.x += one.gradient_of_trace.x;
        sum.dipole.y += one.dipole.y;
    }
    const FieldValues all = superpose(field, sources, 0.7, 0.9, plain);
    CHECK(all.displacement.x == sum.displacement.x);
    CHECK(all.strain.xy == sum.strain.xy);
    CHECK(all.laplacian.y == sum.laplacian.y);
    CHECK(all.gradient_of_trace.x == sum.gradient_of_trace.x);
    CHECK(all.dipole.y == sum.dipole.y);
    CHECK(superpose(field, {}, 0.7, 0.9, plain).displacement.x == 0.0);
    CHECK_THROWS_AS(superpose(field, sources, 1.0, -2.0, plain), InputError);
}

TEST_CASE("gradients are not turned and so not given in the lab frame") {
    const FieldValues f = lab_field(Field({.eta = 1.0, .xi = 1.0}), {}, 1.0, 0.5, oracle::everything);
    CHECK(std::isnan(f.strain_x.xx));
    CHECK(f.strain.xx != 0.0);
}
