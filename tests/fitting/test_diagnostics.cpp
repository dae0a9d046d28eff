// What a fit says besides numbers: minima, flat directions, chi2, data that look wrong.

#include "catch2/catch.hpp"
#include "toy_problems.hpp"

using namespace rodwake::fitting;
using Catch::Matchers::Contains;
using toy::reported;
using toy::says;
using toy::times;
using toy::ys;

TEST_CASE("minima as deep as each other are one, and what tells them apart is said") {
    Problem problem;
    problem.parameters = {toy::bounded("x", 0.5, -10.0, 10.0)};
    problem.residuals = 2;
    problem.evaluate = [](auto p, auto r, Eigen::MatrixXd* jacobian) {
        r << 3.0 * (p[0] * p[0] - 4.0), 1.0;
        if (jacobian)
            *jacobian << 6.0 * p[0], 0.0;
    };
    Method method;
    method.starts = 12;
    const Report r = reported(problem, method);
    CHECK(r.same_optimum == 12);
    CHECK(says(r, "of the 12 starts that ended at the best objective"));
    CHECK(says(r, "the data do not distinguish these"));
    CHECK_FALSE(says(r, "ended elsewhere"));
}

TEST_CASE("couplings that are none are said, and remarks about the data come first") {
    Problem problem = toy::line({1e27, 2e27, 3.1e27});
    problem.parameters[1].name = "kappa";
    problem.remarks = {"tracks.csv: looks odd"};
    const Report r = reported(problem);
    CHECK(r.diagnostics.front() == "tracks.csv: looks odd");
    CHECK(says(r, "is no coupling of rods"));
}

TEST_CASE("nearly flat directions are named too, with finite errors") {
    // y at two places only 1e-4 apart: level and slope can hardly be distinguished
    Problem problem;
    problem.parameters = {toy::positive("level", 1.0), toy::positive("slope", 1.0)};
    problem.residuals = 4;
    problem.evaluate = [](auto p, auto r, Eigen::MatrixXd* jacobian) {
        for (Eigen::Index i = 0; i < 4; ++i) {
            const double x = 1.0 + 1e-4 * static_cast<double>(i % 2);
            r[i] = p[0] + p[1] * x - 2.0 - 1e-6 * static_cast<double>(i);
            if (jacobian)
                jacobian->row(i) << 1.0, x;
        }
    };
    const Report r = reported(problem);
    REQUIRE(r.flat.size() == 1);
    CHECK_THAT(r.flat[0].text, Contains("the data hardly fix level and slope separately"));
    CHECK(r.flat[0].singular_value > 1e-6);
    CHECK(std::isfinite(r.estimates[0].standard_error));
    CHECK(r.estimates[1].standard_error ==
          Approx(1e4).epsilon(1e-3)); // of the slope: 1/sqrt(sum (x - mean)^2) = 1e4
    CHECK(reported(toy::line(ys)).flat.empty());
}

TEST_CASE("chi2 too large or too small is said, with the factor") {
    const Report poor = reported(times(toy::decay(40, 3), 3.0)), fine = reported(toy::decay(40, 3)),
                 small = reported(times(toy::decay(40, 3), 0.3));
    CHECK(says(poor, "poor chi2"));
    CHECK(poor.probability < 1e-10);
    const double factor = std::sqrt(poor.chi2 / 37.0);
    CHECK(factor == Approx(3.0).epsilon(0.4)); // 1 +- sqrt(2/37)/2, three times that
    CHECK(says(poor, "grow by a factor of " + std::to_string(factor).substr(0, 3)));
    CHECK(says(small, "the errors of the data are overestimated"));
    CHECK(fine.diagnostics.empty());
    CHECK(says(poor, "try fit.starts = 20"));
    Problem hopeless = times(toy::decay(40, 3), 1e3); // chi2 of 4e7
    CHECK(says(reported(hopeless), "probability < 1e-300"));
    CHECK_THAT(to_text(hopeless, fit(hopeless, {}), reported(hopeless)), Contains("probability < 1e-300"));
}

TEST_CASE("other minima nearly as good are said") {
    Problem problem;
    problem.parameters = {toy::bounded("x", 0.0, -10.0, 10.0)};
    problem.residuals = 2;
    double tilt = 0.05;
    problem.evaluate = [&tilt](auto p, auto r, Eigen::MatrixXd* jacobian) {
        r << 3.0 * (p[0] * p[0] - 4.0), tilt * (p[0] - 2.0);
        if (jacobian)
            *jacobian << 6.0 * p[0], tilt;
    };
    Method method;
    method.starts = 12;
    const Report r = reported(problem, method);
    CHECK(r.estimates[0].value == Approx(2.0).epsilon(1e-9));
    CHECK(says(r, "starts ended elsewhere and nearly as well; the best of them at x = -2"));
    CHECK((r.same_optimum > 1 && r.same_optimum < 12));
    tilt = 2.0; // the other minimum is 64 above
    CHECK_FALSE(says(reported(problem, method), "ended elsewhere"));
}

TEST_CASE("an unfinished fit is said to be one") {
    Method hasty;
    hasty.levenberg_marquardt = false;
    hasty.max_evaluations = 4;
    CHECK(says(reported(toy::decay(40, 3), hasty), "not converged"));
    hasty.tolerance = 0.5;
    hasty.max_evaluations = 2000;
    CHECK(says(reported(toy::decay(40, 3), hasty), "not at a stationary point"));
}

// A fit that says by hand how far it stopped.
TEST_CASE("how far from stationary is said in degrees, and after a flat direction") {
    const Problem problem = toy::line(ys);
    const auto moved = [&](double distance) {
        Fit best = fit(problem, {});
        best.distance = distance;
        best.values[1] += 1e-3; // not exact
        return report(problem, best);
    };
    CHECK(moved(0.01).diagnostics == moved(0.0).diagnostics);
    CHECK(says(moved(0.1), "not quite at a stationary point: by the gradient the values may be off by 0.1 "));
    CHECK_FALSE(says(moved(0.1), "not to be trusted"));
    CHECK(says(moved(3.0), "worth 3 standard errors; errors are not to be trusted"));
}

TEST_CASE("beside a flat direction a small gradient is not said, a large one after it") {
    const Problem problem = toy::with_idle(toy::line(ys), toy::parameter("idle", 1.0));
    Fit best = fit(problem, {});
    best.values[1] += 1e-3;
    best.distance = 0.1;
    CHECK_FALSE(says(report(problem, best), "stationary point"));
    best.distance = 3.0;
    const Report far = report(problem, best);
    REQUIRE(far.diagnostics.size() >= 2);
    CHECK_THAT(far.diagnostics[0], Contains("do not fix idle"));
    CHECK_THAT(far.diagnostics[1], Contains("not at a stationary point"));
}

TEST_CASE("few starts at the best optimum are said") {
    const Problem problem = toy::line(ys);
    Fit best = fit(problem, {});
    const auto with_ends = [&](std::size_t good, std::size_t all) {
        best.starts.resize(1);
        for (std::size_t i = 1; i < all; ++i) {
            best.starts.push_back(best.starts[0]);
            best.starts[i].index = i;
            best.starts[i].objective += i < good ? 0.0 : 1000.0;
        }
        return report(problem, best);
    };
    CHECK(says(with_ends(4, 20),
               "only 4 of 20 starts reached the best optimum: more starts may find a better one"));
    CHECK_FALSE(says(with_ends(10, 20), "reached the best optimum"));
    CHECK(says(with_ends(2, 5), "only 2 of 5 starts"));
    CHECK_FALSE(says(with_ends(1, 4), "reached the best optimum"));
}
