// Profile likelihoods against curves known exactly, or fitted another way.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "toy_problems.hpp"

#include <algorithm>

using namespace rodwake::fitting;

namespace {

const double z95 = std::sqrt(3.841459);

/// n measurements of one positive parameter, sigma 1, mean m: chi2 = n (p - m)^2 + const.
Problem mean_of(double m, std::size_t n = 9) {
    Problem problem;
    problem.parameters = {toy::positive("p", 1.0)};
    problem.residuals = n;
    problem.evaluate = [m, n](auto p, auto r, Eigen::MatrixXd* jacobian) {
        for (Eigen::Index i = 0; i < r.size(); ++i)
            r[i] = p[0] - m - 0.1 * (static_cast<double>(i) - 0.5 * static_cast<double>(n - 1));
        if (jacobian)
            jacobian->setOnes();
    };
    return problem;
}

ProfileLikelihood profile(const Problem& problem, std::size_t parameter, std::size_t points = 25) {
    return profile_likelihood(problem, {}, fit(problem, {}), parameter, points);
}

} // namespace

TEST_CASE("the profile of a straight line's slope is its parabola") {
    const Problem problem = toy::line(toy::ys);
    const Fit best = fit(problem, {});
    const double b = best.values[1], error = std::sqrt(6.0 / 105.0);
    const ProfileLikelihood p = profile(problem, 1);
    CHECK(std::ranges::is_sorted(p.value));
    CHECK(p.value.size() == p.chi2.size());
    CHECK((p.value.size() >= 21 && p.value.size() <= 35));
    for (std::size_t i = 0; i < p.value.size(); ++i) // the others are re-optimised to rounding errors
        CHECK(p.chi2[i] == Approx(best.chi2 + std::pow((p.value[i] - b) / error, 2)).epsilon(1e-10));
    CHECK(p.chi2.front() >= best.chi2 + 6.0);
    CHECK(p.chi2.back() >= best.chi2 + 6.0);
    CHECK(p.chi2.back() < best.chi2 + 9.0);
    // the crossing is found to 1e-7 of a standard error
    CHECK(p.low.value() == Approx(b - z95 * error).epsilon(1e-6));
    CHECK(p.high.value() == Approx(b + z95 * error).epsilon(1e-6));
}

TEST_CASE("one positive parameter: the exact curve, not symmetric in the logarithm") {
    const ProfileLikelihood p = profile(mean_of(2.0), 0);
    CHECK(p.low.value() == Approx(2.0 - z95 / 3.0).epsilon(1e-6));
    CHECK(p.high.value() == Approx(2.0 + z95 / 3.0).epsilon(1e-6));
    const double least = *std::ranges::min_element(p.chi2);
    for (std::size_t i = 0; i < p.value.size(); ++i)
        CHECK(p.chi2[i] - least == Approx(9.0 * std::pow(p.value[i] - 2.0, 2)).margin(1e-10));
}

TEST_CASE("a side on which the objective never rises enough is unbounded") {
    // towards p = 0 chi2 rises by 9*0.25 = 2.25 at most
    const ProfileLikelihood p = profile(mean_of(0.5), 0);
    CHECK_FALSE(p.low.has_value());
    CHECK(p.high.value() == Approx(0.5 + z95 / 3.0).epsilon(1e-6));
    CHECK(p.value.front() < 1e-6);
    CHECK(p.value.front() > 0.0);
}

TEST_CASE("a bound ends the profile, on the bound itself") {
    Problem problem = mean_of(2.0);
    problem.parameters[0].upper = 2.2;
    const ProfileLikelihood p = profile(problem, 0);
    CHECK(p.value.back() == 2.2);
    CHECK_FALSE(p.high.has_value());
    CHECK(p.low.has_value());
}

TEST_CASE("flat directions have no ends") {
    const Problem problem = toy::with_idle(toy::line({1.0, 2.0, 2.5, 4.5}), toy::parameter("idle", 3.0));
    const ProfileLikelihood p = profile(problem, 2);
    CHECK_FALSE(p.low.has_value());
    CHECK_FALSE(p.high.has_value());
    CHECK(p.value.size() > 5);
    CHECK(profile(problem, 1).low.has_value());
}

TEST_CASE("at the ends the others, fitted anew, give the threshold") {
    const Problem problem = toy::decay(40, 3);
    const Fit best = fit(problem, {});
    for (std::size_t k = 0; k < 3; ++k) {
        CAPTURE(k);
        const ProfileLikelihood p = profile_likelihood(problem, {}, best, k);
        for (const double end : {p.low.value(), p.high.value()}) {
            Problem held = problem;
            held.parameters[k].start = end;
            held.parameters[k].fixed = true;
            CHECK(fit(held, {}).objective - best.objective == Approx(3.841459).epsilon(1e-5));
        }
    }
}

TEST_CASE("sigmas unknown: the threshold grows with the scatter") {
    Problem problem = toy::line(toy::ys);
    problem.sigma_known = false;
    const Fit best = fit(problem, {});
    const double error = std::sqrt(6.0 / 105.0 * best.chi2 / 4.0);
    const ProfileLikelihood p = profile(problem, 1);
    CHECK(p.low.value() == Approx(best.values[1] - z95 * error).epsilon(1e-6));
    CHECK(p.chi2.back() < best.chi2 + 9.0 * best.chi2 / 4.0);
}

TEST_CASE("what is tied moves along") {
    Problem problem = toy::line(toy::ys);
    problem.parameters[0].tied_to = "b";
    problem.parameters[0].tie_factor = 0.5;
    const Fit best = fit(problem, {});
    // model b (x + 0.5): error 1/sqrt(sum (x + 0.5)^2) = 1/sqrt(71.5)
    CHECK(profile(problem, 1).high.value() == Approx(best.values[1] + z95 / std::sqrt(71.5)).epsilon(1e-6));
}

TEST_CASE("robust losses: the ends agree with the interval of the curvature") {
    std::vector<double> y;
    rodwake::RandomStream random(5);
    for (int i = 0; i < 60; ++i)
        y.push_back(toy::normal(random) + (i % 9 == 4 ? 8.0 : 0.0));
    Method method;
    method.loss = Loss::cauchy;
    const Problem problem = toy::line(y);
    const Fit best = fit(problem, method);
    const Report r = report(problem, best);
    const ProfileLikelihood p = profile_likelihood(problem, method, best, 1);
    // not quadratic: agreement is asymptotic, to some 1/sqrt(60)
    CHECK(p.high.value() - best.values[1] == Approx(1.96 * r.estimates[1].standard_error).epsilon(0.25));
}

TEST_CASE("profiles of what is not free are refused") {
    Problem problem = toy::line({1.0, 2.0, 2.5, 4.5});
    const Fit best = fit(problem, {});
    problem.parameters[0].fixed = true;
    CHECK_THROWS_AS(profile_likelihood(problem, {}, best, 0), rodwake::InputError);
    CHECK_THROWS_AS(profile_likelihood(problem, {}, best, 5), rodwake::InputError);
}

TEST_CASE("residuals that throw on the way end a side without an end") {
    Problem problem = mean_of(2.0);
    problem.evaluate = [inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
        if (p[0] > 2.3)
            throw std::runtime_error("beyond the data");
        inner(p, r, jacobian);
    };
    const ProfileLikelihood p = profile(problem, 0);
    CHECK_FALSE(p.high.has_value());
    CHECK(p.low.value() == Approx(2.0 - z95 / 3.0).epsilon(1e-6));
    CHECK(p.value.back() <= 2.3);
}
