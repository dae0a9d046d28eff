// Means with errors, and what is said where an error is not known.

#include "rodwake/core/estimate.hpp"
#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <vector>

using namespace rodwake;

TEST_CASE("an error is known, unknown, or known to have no bound") {
    const double infinite = std::numeric_limits<double>::infinity();
    CHECK_FALSE(Estimate{}.known());
    CHECK_FALSE(Estimate{}.not_fixed());
    CHECK(Estimate{1.0, 0.0, 2}.known());
    CHECK(Estimate{1.0, infinite, 2}.known());
    CHECK(Estimate{1.0, infinite, 2}.not_fixed());
    CHECK_FALSE(Estimate{1.0, 0.5, 2}.not_fixed());
}

TEST_CASE("a change of unit keeps what is unknown") {
    const Estimate known = Estimate{2.0, 0.5, 7}.scaled(4.0),
                   unknown = Estimate{2.0, unknown_error, 1}.scaled(4.0);
    CHECK(known.value == 8.0);
    CHECK(known.error == 2.0);
    CHECK(known.count == 7);
    CHECK(unknown.value == 8.0);
    CHECK_FALSE(unknown.known());
}

TEST_CASE("mean and standard error by hand") {
    const std::array values{1.0, 2.0, 3.0, 6.0};
    const Estimate mean = mean_of(values);
    CHECK(mean.value == 3.0);
    CHECK(mean.error == Approx(std::sqrt(14.0 / 3.0 / 4.0)).epsilon(1e-15)); // round-off
    CHECK(mean.count == 4);
    CHECK(mean_of(std::array{5.0, 5.0}).error == 0.0); // no scatter is a known error
}

TEST_CASE("one value has no known error, none has no mean") {
    const Estimate one = mean_of(std::array{2.5}), none = mean_of({});
    CHECK(one.value == 2.5);
    CHECK(one.count == 1);
    CHECK_FALSE(one.known());
    CHECK(none.count == 0);
    CHECK_FALSE(none.known());
}

TEST_CASE("the standard error is the scatter of many means") {
    RandomStream random(91);
    constexpr int many = 4000;
    double squares = 0.0, claimed = 0.0;
    for (int i = 0; i < many; ++i) {
        std::vector<double> values(5);
        for (double& value : values)
            value = random.uniform(-1.0, 1.0);
        const Estimate mean = mean_of(values);
        squares += mean.value * mean.value / many;
        claimed += mean.error * mean.error / many;
    }
    CHECK(squares == Approx(1.0 / 15.0).epsilon(0.09)); // 4 standard errors of a variance, sqrt(2/4000)
    CHECK(claimed == Approx(1.0 / 15.0).epsilon(0.09));
}
