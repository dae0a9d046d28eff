// The chain from the user's Jacobian to the gradient of the objective in coordinates of the search.

#include "toy_problems.hpp"

#include "fitting/evaluator.hpp"
#include "fitting/search.hpp"

#include <catch2/catch.hpp>

using namespace rodwake::fitting;

namespace {

/// Of the objective, by central differences. Their error is h^2/6 f''' (1e-12 f''') plus rounding eps f/h
/// (1e-10 f): 1e-6 of the gradient's size leaves room.
Eigen::VectorXd by_differences(Evaluator& evaluator, const Eigen::VectorXd& u) {
    const double h = 1e-6;
    Eigen::VectorXd gradient(u.size());
    for (Eigen::Index k = 0; k < u.size(); ++k) {
        Eigen::VectorXd up = u, down = u;
        up[k] += h;
        down[k] -= h;
        gradient[k] = (evaluator(up, false).objective - evaluator(down, false).objective) / (up[k] - down[k]);
    }
    return gradient;
}

/// Largest difference relative to the gradient's norm.
double error_of_gradient(const Problem& problem, const LossShape& loss) {
    const SearchSpace space(problem);
    Evaluator evaluator(problem, space, loss);
    std::vector<double> start;
    for (const std::size_t i : space.free)
        start.push_back(problem.parameters[i].start);
    const Eigen::VectorXd u = space.coordinates(start), exact = evaluator.gradient(evaluator(u, true));
    return (by_differences(evaluator, u) - exact).cwiseAbs().maxCoeff() / exact.norm();
}

Problem tied_decay() {
    Problem problem = toy::decay(40, 7);
    problem.parameters[0].scale = 0.37;
    problem.parameters[1].scale = 2.5;
    problem.parameters[2].tied_to = "a";
    problem.parameters[2].tie_factor = -0.3;
    return problem;
}

} // namespace

TEST_CASE("gradients are those of central differences, for every loss") {
    for (const Loss loss : {Loss::squares, Loss::huber, Loss::cauchy}) {
        CAPTURE(static_cast<int>(loss));
        CHECK(error_of_gradient(toy::decay(40, 7), {loss, 1.5}) < 1e-6);
        CHECK(error_of_gradient(tied_decay(), {loss, 0.7}) < 1e-6);
        CHECK(error_of_gradient(toy::rosenbrock(-1.2, 1.0), {loss, 1.5}) < 1e-6);
    }
}

TEST_CASE("a tie to a logarithmic parameter") {
    Problem problem = toy::decay(40, 7);
    problem.parameters[2].tied_to = "b";
    problem.parameters[2].tie_factor = 0.4;
    CHECK(error_of_gradient(problem, {}) < 1e-6);
}

TEST_CASE("the check of gradients sees a wrong Jacobian") {
    Problem wrong = toy::decay(40, 7);
    wrong.evaluate = [right = wrong.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
        right(p, r, jacobian);
        if (jacobian)
            jacobian->col(1) *= 1.001;
    };
    CHECK(error_of_gradient(wrong, {}) > 1e-5);
}

// Huber, Proc. 1964, and Cauchy's ln(1 + s): values by hand at s below, at and beyond the width.
TEST_CASE("losses: values, continuity, derivatives") {
    const LossShape huber{Loss::huber, 2.0}, cauchy{Loss::cauchy, 2.0};
    CHECK(loss_of(huber, 3.0).rho == 3.0);
    CHECK(loss_of(huber, 9.0).rho == Approx(2.0 * 2.0 * 3.0 - 4.0));
    CHECK(loss_of(huber, 4.0 + 1e-12).rho == Approx(loss_of(huber, 4.0).rho));
    CHECK(loss_of(cauchy, 4.0).rho == Approx(4.0 * std::log(2.0)));
    for (const LossShape& shape : {huber, cauchy})
        for (const double s : {0.5, 3.0, 5.0, 40.0}) {
            const double h =
                1e-5 * s; // central differences: error h^2 of the scale of the function, and eps/h
            const auto up = loss_of(shape, s + h), down = loss_of(shape, s - h), here = loss_of(shape, s);
            CHECK(here.first == Approx((up.rho - down.rho) / (2.0 * h)).epsilon(1e-7));
            CHECK(here.second == Approx((up.first - down.first) / (2.0 * h)).epsilon(1e-7).margin(1e-10));
        }
}

// --- One step of Levenberg-Marquardt within bounds

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
