// Conversions between the ways a medium is given.

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/medium.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace rodwake;
using namespace rodwake::elastic;

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
