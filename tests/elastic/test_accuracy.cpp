// The field against the oracle over random points of every kind: the header's accuracy claim.

#include "error_norm.hpp"
#include "sample.hpp"

#include <catch2/catch.hpp>
#include <cstdio>

using namespace rodwake;
using namespace rodwake::oracle;

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
