// No finite point and no legal medium gives a NaN or an infinity; what is illegal says so.

#include "error_norm.hpp"
#include "sample.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/elastic/medium.hpp"
#include "rodwake/elastic/periodic.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

using namespace rodwake;
using namespace rodwake::oracle;
using namespace rodwake::elastic;

namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();

bool plain_finite(const elastic::FieldValues& f) {
    for (int k = 0; k < plain_quantities; ++k)
        for (const double value : components(f, static_cast<Quantity>(k)))
            if (!std::isfinite(value))
                return false;
    return true;
}

bool finite_at(const Point& p) {
    return plain_finite(elastic::Field({.eta = p.eta, .xi = p.xi}).at(p.x, p.y, everything));
}

int count_bad(int points, std::uint64_t seed) {
    RandomStream random(seed);
    int bad = 0;
    for (int k = 0; k < points; ++k)
        bad += !finite_at(random_point(random, static_cast<Angle>(k % angles), Stiffness::decades));
    return bad;
}

elastic::FieldValues at(double x, double y, double xi = 1.0) {
    return elastic::Field({.eta = 1.0, .xi = xi}).at(x, y, everything);
}

} // namespace

TEST_CASE("random points give finite values") { CHECK(count_bad(200'000, 31) == 0); }

TEST_CASE("ten million random points give finite values", "[.][long]") {
    CHECK(count_bad(10'000'000, 32) == 0);
}

TEST_CASE("the finite check can fail") {
    elastic::FieldValues f{};
    CHECK(plain_finite(f));
    f.dipole.y = nan_value;
    CHECK_FALSE(plain_finite(f));
    f.dipole.y = 0.0;
    f.strain.xy = infinity;
    CHECK_FALSE(plain_finite(f));
}

TEST_CASE("extreme coordinates and media give finite values") {
    const double tiny = std::numeric_limits<double>::denorm_min(), far[] = {-1e300, -1e200, 1e200, 1e300};
    for (const double eta : {-1.0 + 1e-15, -0.5, 0.0, 1e-300, 1.0, elastic::Medium::max_eta})
        for (const double xi : {elastic::Medium::min_xi, 1.0, elastic::Medium::max_xi})
            for (const double x : far)
                for (const double y : {0.0, tiny, 1.0, x}) {
                    CAPTURE(eta, xi, x, y);
                    if (std::hypot(x / xi, y / xi) <= 1.5e300) {
                        CHECK(finite_at({x, y, xi, eta}));
                        CHECK(finite_at({y, x, xi, eta}));
                    } else {
                        CHECK_THROWS_AS(finite_at({x, y, xi, eta}), InputError);
                    }
                }
    for (const double r : {1.01e-100, 1e-60, 1e-20})
        for (const double xi : {elastic::Medium::min_xi, 1.0, elastic::Medium::max_xi}) {
            CHECK(finite_at({r * xi, tiny, xi, 1.0}));
            CHECK(finite_at({-r * xi, r * xi, xi, 1e6}));
            CHECK(finite_at({tiny, -r * xi, xi, -0.9}));
        }
}

TEST_CASE("the rod itself and points that are not finite are errors") {
    CHECK_THROWS_AS(at(0.0, 0.0), InputError);
    CHECK_THROWS_AS(at(-0.0, 0.0), InputError);
    CHECK_THROWS_AS(at(0.6e-100, 0.6e-100), InputError);
    CHECK_THROWS_AS(at(1e-318, -1e-320, 1e6), InputError); // subnormal coordinates beside a large xi
    for (const double bad : {nan_value, infinity, -infinity}) {
        CHECK_THROWS_AS(at(bad, 1.0), InputError);
        CHECK_THROWS_AS(at(1.0, bad), InputError);
        CHECK_THROWS_AS(at(bad, bad), InputError);
    }
    CHECK_THROWS_AS(at(1e300, 0.0, 1e-3), InputError); // r/xi = 1e303
}

TEST_CASE("illegal media are errors") {
    const auto build = [](double eta, double xi) { return elastic::Field({.eta = eta, .xi = xi}); };
    CHECK_NOTHROW(build(1.0, 1.0));
    for (const double eta : {-1.0, -2.0, 1.1e12, nan_value, infinity, -infinity})
        CHECK_THROWS_AS(build(eta, 1.0), InputError);
    for (const double xi : {0.0, -1.0, 0.9e-30, 1.1e30, nan_value, infinity})
        CHECK_THROWS_AS(build(1.0, xi), InputError);
}

TEST_CASE("only what is asked for is computed, and the rest is no number") {
    const elastic::Field field({.eta = 1.0, .xi = 1.0});
    const elastic::FieldValues only = field.at(0.3, 0.2, {.strain = true}),
                               all = field.at(0.3, 0.2, everything);
    CHECK(only.strain.xy == all.strain.xy);
    CHECK(std::isnan(only.displacement.x));
    CHECK(std::isnan(only.laplacian.x));
    CHECK(std::isnan(only.dipole.y));
    CHECK(std::isnan(only.strain_x.xx));
    CHECK(all.strain_x.xx != 0.0);
}

TEST_CASE("a request for nothing gives no zeros to take for a field") {
    static_assert(sizeof(elastic::FieldValues) % sizeof(double) == 0);
    const auto numbers = [](const elastic::FieldValues& f) {
        const auto all = std::bit_cast<std::array<double, sizeof(f) / sizeof(double)>>(f);
        return std::ranges::count_if(all, [](double v) { return !std::isnan(v); });
    };
    for (const double x : {1e-3, 0.3, 40.0}) { // core, near, far
        CHECK(numbers(elastic::Field({}).at(x, 0.2, {})) == 0);
        CHECK(numbers(elastic::lab_field(elastic::Field({}), {}, x, 0.2, {})) == 0);
        CHECK(numbers(elastic::PeriodicField({}, 100.0).at(x, 0.2, {})) == 0);
        CHECK(numbers(elastic::medium_derivatives(elastic::Field({}), x, 0.2, {}).by_eta) == 0);
        CHECK(numbers(elastic::PeriodicField({}, 100.0).medium_derivatives(x, 0.2, {}).by_xi) == 0);
        CHECK(numbers(elastic::Field({}).at(x, 0.2, everything)) == 25);
    }
    CHECK(numbers(elastic::PeriodicField({}, 100.0).self_image_field({})) == 0);
}

// --- Conversions between the ways a medium is given

namespace {

constexpr double ulp = std::numeric_limits<double>::epsilon();

}

TEST_CASE("eta from the free energy's coefficients") {
    CHECK(eta_from_lame(0.0, 1.0) == 1.0); // lambda_L = 0: K = mu
    CHECK(eta_from_lame(3.0, 2.0) == 2.5);
    CHECK(eta_from_bulk_modulus(5.0, 2.0) == 2.5); // K = lambda_L + mu, the same medium
    CHECK(eta_from_poisson_ratio(0.0) == 1.0);     // lambda_L = 0
    CHECK(eta_from_poisson_ratio(3.0 / 7.0) ==
          Approx(2.5).epsilon(4 * ulp)); // lambda_L/(lambda_L + 2 mu); few roundings
}

TEST_CASE("the Poisson ratio comes back") {
    RandomStream random(101);
    for (int k = 0; k < 200; ++k) {
        const double eta = random.log_uniform(1e-3, 1e3), p = poisson_ratio(eta);
        // 1 - p = 2/(1 + eta) and 1 + p = 2 eta/(1 + eta): a rounding of p counts that much more.
        CHECK(eta_from_poisson_ratio(p) == Approx(eta).epsilon(4 * ulp * (1.0 + eta) * (1.0 + 1.0 / eta)));
    }
    CHECK(eta_from_poisson_ratio(-1.0 + 1e-12) <
          1e-11);                                    // incompressible the other way: the bulk modulus goes
    CHECK(eta_from_poisson_ratio(1.0 - 1e-9) > 1e9); // incompressible
}

TEST_CASE("nu is one over one plus eta") {
    CHECK(Medium{.eta = 1.0}.nu() == 0.5);
    CHECK(Medium{.eta = 0.0}.nu() == 1.0);
    CHECK(Medium{.eta = -0.5}.nu() == 2.0);
}

TEST_CASE("xi from the paper's alpha") {
    CHECK(xi_from_alpha(0.1, 2.2) == Approx(22.0).epsilon(4 * ulp)); // the paper's fit
    CHECK(xi_from_alpha(4.0) == 0.25);
}

TEST_CASE("conversions refuse what is not a medium") {
    const double nan_value = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
    for (const double mu : {0.0, -1.0, nan_value}) {
        CHECK_THROWS_AS(eta_from_lame(1.0, mu), InputError);
        CHECK_THROWS_AS(eta_from_bulk_modulus(1.0, mu), InputError);
    }
    CHECK_THROWS_AS(eta_from_lame(-2.0, 1.0), InputError);
    CHECK_THROWS_AS(eta_from_lame(nan_value, 1.0), InputError);
    CHECK_THROWS_AS(eta_from_bulk_modulus(-1.0, 1.0), InputError);
    for (const double p : {-1.0, 1.0, 2.0, nan_value})
        CHECK_THROWS_AS(eta_from_poisson_ratio(p), InputError);
    CHECK_THROWS_AS(poisson_ratio(-1.0), InputError);
    for (const double alpha : {0.0, -1.0, nan_value, infinity})
        CHECK_THROWS_AS(xi_from_alpha(alpha), InputError);
    CHECK_THROWS_AS(xi_from_alpha(1.0, 0.0), InputError);
    CHECK_THROWS_AS(xi_from_alpha(1.0, nan_value), InputError);
}

TEST_CASE("a refused value is shown with its digits") {
    CHECK_THROWS_WITH(validate({.eta = 1.0, .xi = 1e-31}), Catch::Contains("1e-31"));
    CHECK_THROWS_WITH(validate({.eta = -1.5, .xi = 1.0}), Catch::Contains("eta = -1.5"));
}
