// The field, and the oracle, against the reference table.

#include "error_norm.hpp"
#include "reference_table.hpp"
#include "sample.hpp"

#include "rodwake/core/error.hpp"

#include <boost/math/special_functions/bessel.hpp>
#include <catch2/catch.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

using namespace rodwake;
using namespace rodwake::oracle;

namespace {

const std::string path = RODWAKE_TEST_DATA "/elastic_field.csv";

Real distance(const std::vector<Real>& a, const std::vector<Real>& b) {
    Real sum = 0, scale = 0;
    for (std::size_t k = 0; k < b.size(); ++k) {
        sum += (a[k] - b[k]) * (a[k] - b[k]);
        scale += b[k] * b[k];
    }
    return scale == 0 ? sqrt(sum) : sqrt(sum / scale);
}

elastic::FieldValues field_at(const Point& p) {
    return elastic::Field({.eta = p.eta, .xi = p.xi}).at(p.x, p.y, everything);
}

} // namespace

TEST_CASE("the field agrees with the reference table at every point") {
    const std::vector<ReferenceRow> rows = reference_table(path);
    REQUIRE(rows.size() == 320);
    Worst worst;
    for (const ReferenceRow& row : rows)
        for (int k = 0; k < plain_quantities; ++k) {
            const auto q = static_cast<Quantity>(k);
            worst.include(q, relative_error(components(field_at(row.point), q), components(row, q)),
                          row.point);
        }
    for (int k = 0; k < plain_quantities; ++k) {
        CAPTURE(name(static_cast<Quantity>(k)), worst.at[k].x, worst.at[k].y, worst.at[k].xi,
                worst.at[k].eta);
        CHECK(worst.error[k] <= 2e-13); // the header's guarantee
    }
}

TEST_CASE("the oracle agrees with the reference table to its 25 digits") {
    for (const ReferenceRow& row : reference_table(path)) {
        const Field exact(row.point);
        for (int k = 0; k < plain_quantities; ++k) {
            const auto q = static_cast<Quantity>(k);
            CAPTURE(name(q), row.point.x, row.point.y);
            CHECK(distance(components(exact, q), components(row, q)) <
                  1e-24); // half a unit of digit 25, two of them
        }
    }
}

TEST_CASE("a swapped component of the reference is noticed") {
    ReferenceRow row = reference_table(path).front();
    const std::vector<double> got = components(field_at(row.point), Quantity::displacement);
    std::swap(row.numbers[0], row.numbers[1]);
    CHECK(relative_error(got, components(row, Quantity::displacement)) > 1e-3); // far above any rounding
}

TEST_CASE("a reference table that is missing or damaged is an error") {
    CHECK_THROWS_AS(reference_table(RODWAKE_TEST_DATA "/no_such_file.csv"), InputError);
    const auto damaged = [](const std::string& row) {
        const std::filesystem::path file =
            std::filesystem::temp_directory_path() / "rodwake_damaged_reference.csv";
        std::ofstream(file) << "# comment\nheader\n" << row << '\n';
        return file.string();
    };
    CHECK_THROWS_AS(reference_table(damaged("1,2,3")), InputError);
    CHECK_THROWS_AS(reference_table(damaged("1,2,3,4,5,6,7,8,9,10,11,12,13,14,x")), InputError);
    CHECK(reference_table(damaged("1,2,3,4,5,6,7,8,9,10,11,12,13,14,15")).size() == 1);
    ReferenceRow row;
    CHECK_THROWS_AS(components(row, Quantity::strain_gradients), InputError);
}

// --- The field against the oracle over random points of every kind: the header's accuracy claim

namespace {

Worst worst_of(int points, std::uint64_t seed) {
    RandomStream random(seed);
    Worst worst;
    for (int k = 0; k < points; ++k)
        worst.include(random_point(random, k));
    return worst;
}

void check(const Worst& worst) {
    for (int k = 0; k < all_quantities; ++k) {
        const Point& p = worst.at[k];
        CAPTURE(name(static_cast<Quantity>(k)), p.x, p.y, p.xi, p.eta);
        CHECK(worst.error[k] <=
              1e-12); // the header's bound off the axis, with room for zeros of a vector on the axis
    }
}

} // namespace

TEST_CASE("the field agrees with the oracle at random points") { check(worst_of(300, 21)); }

TEST_CASE("the field agrees with the oracle at 30000 random points", "[.][long]") {
    const Worst worst = worst_of(30000, 22);
    for (int k = 0; k < all_quantities; ++k)
        std::printf("%-18s worst relative error %.1e at x/xi = %.3g, y/xi = %.3g, eta = %.3g\n",
                    name(static_cast<Quantity>(k)).c_str(), worst.error[k], worst.at[k].x / worst.at[k].xi,
                    worst.at[k].y / worst.at[k].xi, worst.at[k].eta);
    check(worst);
}

TEST_CASE("values that a small unit lifts above the underflow of their exponential are kept") {
    // exp(-713) = 2e-310 is subnormal, but xi = 1e-12 multiplies the second derivatives by 1e24.
    const double xi = 1e-12;
    const Point p{713.0 * xi, 3.0 * xi, xi, 0.0};
    const Field exact(p);
    const auto truth = components(exact, Quantity::laplacian);
    REQUIRE(norm(truth) > smallest_norm);
    const auto got =
        components(elastic::Field({.eta = p.eta, .xi = xi}).at(p.x, p.y, everything), Quantity::laplacian);
    CHECK(relative_error(got, truth) < 1e-14); // eight digits would be gone from a subnormal exponential
}

TEST_CASE("small components keep their own digits for nearly equal potentials") {
    RandomStream random(23);
    for (int k = 0; k < 100; ++k) {
        Point p = random_point(random, Angle::uniform, Stiffness::decades);
        p.eta = random.log_uniform(1e-12, 1e-3);
        const Field exact(p);
        const auto got = elastic::Field({.eta = p.eta, .xi = p.xi}).at(p.x, p.y, everything).displacement.y;
        if (abs(exact.uy(0, 0)) > smallest_norm) {
            CAPTURE(p.x, p.y, p.xi, p.eta);
            CHECK(relative_error({got}, {exact.uy(0, 0)}) <
                  1e-11); // U_y is eta times its parts; near its zero lines less
        }
    }
}

TEST_CASE("lap u keeps its digits ahead on the axis, where its singular terms cancel near r = eta xi") {
    for (double eta = 1e-1; eta > 1e-10; eta *= 0.1)
        for (const double shift : {1.0, 1.0 + 1e-3, 1.0 - 1e-6}) {
            const Point p{eta * shift, 0.0, 1.0, eta};
            const Field exact(p);
            const auto got = components(elastic::Field({.eta = p.eta, .xi = p.xi}).at(p.x, p.y, everything),
                                        Quantity::laplacian);
            CAPTURE(p.x, p.eta);
            CHECK(relative_error(got, components(exact, Quantity::laplacian)) <
                  2e-14); // 1 ulp over the rest, 1/100
        }
}

// --- The oracle itself: the medium's equation, which it does not use, and helpers that must be able to fail

namespace {

/// |-(1/xi) d_x U - lap U - eta grad div U| over the sum of the sizes of its parts, for a force along x or y.
template<class X, class Y>
Real residual(const X& ux, const Y& uy, const Point& p) {
    const Real xi = p.xi, eta = p.eta;
    const Real x[] = {ux(1, 0) / xi, ux(2, 0), ux(0, 2), eta * ux(2, 0), eta * uy(1, 1)};
    const Real y[] = {uy(1, 0) / xi, uy(2, 0), uy(0, 2), eta * ux(1, 1), eta * uy(0, 2)};
    Real sum_x = 0, sum_y = 0, scale = 0;
    for (int k = 0; k < 5; ++k) {
        sum_x += x[k];
        sum_y += y[k];
        scale += abs(x[k]) + abs(y[k]);
    }
    return (abs(sum_x) + abs(sum_y)) / scale;
}

Real residual_x(const Point& p, const Field& f) {
    return residual([&](int i, int j) { return f.ux(i, j); }, [&](int i, int j) { return f.uy(i, j); }, p);
}

Real residual_y(const Point& p, const Field& f) {
    return residual([&](int i, int j) { return f.vx(i, j); }, [&](int i, int j) { return f.vy(i, j); }, p);
}

} // namespace

TEST_CASE("the oracle solves the medium's equation for both forces") {
    RandomStream random(11);
    for (int k = 0; k < 200; ++k) {
        const Point p = random_point(random, k);
        const Field f(p);
        CAPTURE(p.x, p.y, p.xi, p.eta);
        if (f.ux(1, 0) == 0)
            continue; // decayed past every exponent
        CHECK(residual_x(p, f) <
              1e-30); // 220 digits less the cancellation of third derivatives at r/xi = 1e-12
        CHECK(residual_y(p, f) < 1e-30); // the same
    }
}

TEST_CASE("the residual sees a wrong medium") {
    const Point p{0.3, -0.4, 2.0, 1.5};
    const Field f(p);
    CHECK(residual_x({p.x, p.y, p.xi, 1.5000001}, f) > 1e-9);  // eta off by 1e-7
    CHECK(residual_x({p.x, p.y, 2.0000001, p.eta}, f) > 1e-9); // xi off by 1e-7
}

TEST_CASE("the oracle's Bessel functions agree with Boost's and across the switch of series") {
    for (const double z : {1e-12, 0.3, 1.0, 7.0, 50.0, 139.0, 141.0, 600.0}) {
        const ScaledPair k = scaled_bessel(z);
        const double decay = std::exp(-z), tolerance = 1e-13; // exp(-600) in double costs 600/2 ulp
        CHECK(std::abs(static_cast<double>(k.k0) * decay / boost::math::cyl_bessel_k(0, z) - 1.0) <
              tolerance);
        CHECK(std::abs(static_cast<double>(k.k1) * decay / boost::math::cyl_bessel_k(1, z) - 1.0) <
              tolerance);
    }
    // K1 = -K0' across z = 140, by a fourth difference that reads both series: h^4/30 f''''' = 1e-41 of K0.
    const Real h = Real(1) / Real("1e10"), z = 140;
    const auto k0 = [](const Real& at) { return Real(exp(-(at - 140)) * scaled_bessel(at).k0); };
    const Real slope = (8 * (k0(z + h) - k0(z - h)) - (k0(z + 2 * h) - k0(z - 2 * h))) / (12 * h);
    CHECK(abs(slope / scaled_bessel(z).k1 + 1) < 1e-38); // the truncation above, with room
}

TEST_CASE("the relative error can fail") {
    const std::vector<Real> exact{3, 4};
    CHECK(relative_error({3.0, 4.0}, exact) == 0.0);
    CHECK(relative_error({3.0, 4.5}, exact) == Approx(0.1));
    CHECK(relative_error({3.0}, exact) == std::numeric_limits<double>::infinity());
    CHECK(relative_error({3.0, std::nan("")}, exact) == std::numeric_limits<double>::infinity());
    Worst worst;
    worst.include(Quantity::strain, std::numeric_limits<double>::infinity(), {});
    worst.include(Quantity::strain, 0.5, {});
    CHECK(worst.error[static_cast<int>(Quantity::strain)] == std::numeric_limits<double>::infinity());
}

TEST_CASE("random points reach the corners they are drawn for") {
    RandomStream random(12);
    for (int k = 0; k < 300; ++k) {
        const Point axis = random_point(random, Angle::axes, Stiffness::zero);
        CHECK((axis.x == 0.0) != (axis.y == 0.0));
        CHECK(axis.eta == 0.0);
        const Point wake = random_point(random, Angle::near_wake, Stiffness::negative);
        CHECK((wake.x < 0.0 && std::abs(wake.y) < 0.11 * std::abs(wake.x) && wake.eta < 0.0));
        CHECK(random_point(random, Angle::near_front, Stiffness::decades).x > 0.0);
    }
    int large = 0;
    for (int k = 0; k < 300; ++k) {
        const Point p = random_point(random, Angle::large_exponent, Stiffness::decades);
        large += (p.x + std::hypot(p.x, p.y)) / (2.0 * p.xi) > 300.0;
    }
    CHECK(large > 50); // drawn evenly up to 760 wherever r is large enough for it
}
