// One step of Levenberg-Marquardt within bounds.

#include "catch2/catch.hpp"
#include "fitting/search.hpp"
#include "toy_problems.hpp"

using namespace rodwake::fitting;

namespace {

/// |A u - (1, 1)|^2 from u = 0, columns strongly coupled; the free minimum is at (1/1.9, 1/1.9).
const Weighted coupled{(Eigen::Matrix2d() << 1.0, 0.9, 0.9, 1.0).finished(), Eigen::Vector2d(-1.0, -1.0), {}};

DampedStep step(double lower, double upper, double lambda = 0.0) {
    Problem problem = toy::line({0.0, 0.0});
    problem.parameters[0] = toy::bounded("a", 0.0, lower, upper);
    problem.parameters[0].scale = 1.0;
    return damped_step(coupled, SearchSpace(problem), Eigen::Vector2d::Zero(), Eigen::Vector2d::Ones(),
                       lambda);
}

} // namespace

TEST_CASE("undamped and unbounded, a step ends at the minimum") {
    const DampedStep s = step(-5.0, 5.0);
    CHECK(s.step[0] == Approx(1.0 / 1.9).epsilon(1e-12));
    CHECK(s.step[1] == Approx(1.0 / 1.9).epsilon(1e-12));
    CHECK(s.predicted == Approx(2.0).epsilon(1e-12));
}

TEST_CASE("a coordinate stopped by its bound, the other goes to the minimum that is left") {
    const DampedStep s = step(-5.0, 0.2);
    CHECK(s.step[0] == 0.2);
    // by hand: (0.9 (1 - 0.2) + 1 - 0.9*0.2)/(0.81 + 1)
    CHECK(s.step[1] == Approx((0.9 * 0.8 + 1.0 - 0.18) / 1.81).epsilon(1e-12));
    const double left = std::pow(0.2 + 0.9 * s.step[1] - 1.0, 2) + std::pow(0.18 + s.step[1] - 1.0, 2);
    CHECK(s.predicted == Approx(2.0 - left).epsilon(1e-12));
}

TEST_CASE("a coordinate held by its bound does not move") {
    const DampedStep s = step(-5.0, 0.0);
    CHECK(s.step[0] == 0.0);
    CHECK(s.step[1] == Approx(1.9 / 1.81).epsilon(1e-12));
}

TEST_CASE("damping shortens the step") {
    CHECK(step(-5.0, 5.0, 1e6).step.norm() ==
          Approx(std::sqrt(2.0) * 1.9e-6).epsilon(1e-5)); // gradient/lambda
    CHECK(step(-5.0, 5.0, 1.0).predicted < step(-5.0, 5.0, 0.1).predicted);
}
