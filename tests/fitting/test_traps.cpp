// Problems that go wrong on purpose.

#include "toy_problems.hpp"

#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace rodwake::fitting;
using Catch::Matchers::Contains;
using rodwake::InputError;
using toy::says;

namespace {

/// Where `bad(p)`, the residuals throw or are NaN, as given.
template<class Bad>
Problem spoilt(Problem problem, Bad bad, bool throws) {
    problem.evaluate = [=, inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
        inner(p, r, jacobian);
        if (bad(p) && throws)
            throw std::runtime_error("no field here");
        if (bad(p))
            r[0] = std::numeric_limits<double>::quiet_NaN();
    };
    return problem;
}

bool any_nan(const Fit& fit, const Report& report) {
    bool found = std::isnan(fit.objective) || std::isnan(fit.chi2) || std::isnan(fit.distance) ||
                 report.covariance.hasNaN() || report.correlation.hasNaN() || report.root.hasNaN() ||
                 std::isnan(report.probability) || std::isnan(report.error_factor);
    for (const ParameterEstimate& e : report.estimates)
        found = found || std::isnan(e.value) || std::isnan(e.standard_error) || std::isnan(e.low) ||
                std::isnan(e.high);
    for (const FlatDirection& flat : report.flat)
        found = found || std::ranges::any_of(flat.change, [](double c) { return std::isnan(c); });
    return found;
}

/// Only the product eta*xi matters, and offset: r_i = eta xi x_i + offset - y_i.
Problem product_only() {
    Problem problem;
    problem.parameters = {toy::positive("eta", 2.0), toy::positive("xi", 5.0), toy::parameter("offset", 0.0)};
    problem.residuals = 12;
    problem.evaluate = [](auto p, auto r, Eigen::MatrixXd* jacobian) {
        for (Eigen::Index i = 0; i < r.size(); ++i) {
            const double x = static_cast<double>(i);
            r[i] = p[0] * p[1] * x + p[2] - (3.0 * x + 1.0 + 0.5 * std::sin(5.0 * x));
            if (jacobian)
                jacobian->row(i) << p[1] * x, p[0] * x, 1.0;
        }
    };
    return problem;
}

} // namespace

TEST_CASE("residuals that throw or are not finite in places: every algorithm goes around") {
    for (const bool throws : {true, false})
        for (const Algorithm algorithm :
             {Algorithm::bobyqa, Algorithm::nelder_mead, Algorithm::slsqp, Algorithm::lbfgs, Algorithm::mma,
              Algorithm::mlsl, Algorithm::crs, Algorithm::isres, Algorithm::direct_l}) {
            CAPTURE(throws, to_string(algorithm));
            Problem problem = toy::rosenbrock(-1.2, 1.0);
            for (Parameter& p : problem.parameters) {
                p.lower = -5.0;
                p.upper = 5.0;
            }
            // a wall close above the valley and one beyond its end
            problem = spoilt(
                problem, [](auto p) { return p[1] > p[0] * p[0] + 1.0 || p[0] > 1.5; }, throws);
            Method method;
            method.algorithm = algorithm;
            const Fit best = fit(problem, method);
            CHECK(best.values[0] == Approx(1.0).epsilon(1e-8));
            CHECK_FALSE(any_nan(best, report(problem, best)));
            method.levenberg_marquardt =
                false; // the wall must not look good to NLopt itself: 24.2 at the start
            CHECK(fit(problem, method).objective < 0.05);
        }
}

TEST_CASE("nowhere a finite residual: failed, with the reason, and no NaN") {
    for (const Algorithm algorithm :
         {Algorithm::slsqp, Algorithm::bobyqa, Algorithm::lbfgs, Algorithm::mma}) {
        CAPTURE(to_string(algorithm));
        Method method;
        method.algorithm = algorithm;
        method.starts = 3;
        Problem problem = spoilt(
            toy::decay(), [](auto) { return true; }, true);
        const Fit none = fit(problem, method);
        CHECK(none.termination == Termination::failed);
        CHECK_THAT(none.reason, Contains("no field here") && !Contains("REACHED"));
        CHECK(std::isinf(none.objective));
        CHECK(none.values == std::vector<double>{1.0, 1.0, 0.1});
        const Report r = report(problem, none);
        CHECK_FALSE(any_nan(none, r));
        CHECK(says(r, "the fit failed"));
        CHECK_NOTHROW(to_text(problem, none, r));
        problem = spoilt(
            toy::decay(), [](auto) { return true; }, false);
        problem.residual_name = [](std::size_t i) { return "profile.csv:" + std::to_string(i + 2); };
        CHECK_THAT(fit(problem, method).reason, Contains("residual profile.csv:2 is not a finite number"));
    }
}

TEST_CASE("a bad start among good ones is counted, not fatal") {
    const Problem problem = spoilt(
        toy::decay(40, 3), [](auto p) { return p[0] == 1.0 && p[1] == 1.0; }, true);
    Method method;
    method.starts = 4;
    const Fit best = fit(problem, method);
    CHECK(best.termination == Termination::converged);
    CHECK(std::isinf(best.starts[0].objective));
    CHECK(says(report(problem, best), "1 of 4 starts found no point with finite residuals"));
}

TEST_CASE("a derivative that is not finite is caught") {
    Problem problem = toy::decay(40, 3);
    problem.evaluate = [inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
        inner(p, r, jacobian);
        if (jacobian)
            (*jacobian)(5, 1) = std::numeric_limits<double>::infinity();
    };
    const Fit none = fit(problem, {});
    CHECK(none.termination == Termination::failed);
    CHECK_THAT(none.reason, Contains("a derivative of residual 5 is not a finite number"));
    Method without;
    without.algorithm = Algorithm::nelder_mead;
    for (const bool levenberg_marquardt : {true, false}) {
        without.levenberg_marquardt = levenberg_marquardt;
        const Fit blind = fit(problem, without);
        CHECK(blind.objective < 60.0);
        CHECK(blind.termination == Termination::converged);
        CHECK_FALSE(any_nan(blind, report(problem, blind)));
    }
}

TEST_CASE("a parameter that changes nothing has an infinite error, and is named") {
    const Problem problem = toy::with_idle(toy::decay(40, 3), toy::parameter("d", 7.0));
    const Fit best = fit(problem, {}), expected = fit(toy::decay(40, 3), {});
    const Report r = report(problem, best), without = report(toy::decay(40, 3), expected);
    CHECK(best.termination == Termination::converged);
    CHECK(best.values[3] == 7.0);
    CHECK(std::isinf(r.estimates[3].standard_error));
    CHECK(r.rank == 3);
    REQUIRE(r.flat.size() == 1);
    CHECK_THAT(r.flat[0].text, Contains("the data do not fix d: the residuals do not depend on it"));
    CHECK(r.flat[0].change == std::vector<double>{0.0, 0.0, 0.0, 1.0});
    CHECK(r.dof == 36); // d was fitted too
    CHECK(without.dof == 37);
    for (std::size_t k = 0; k < 3;
         ++k) // the other three as without it, but for where Levenberg-Marquardt stopped
        CHECK(r.estimates[k].standard_error == Approx(without.estimates[k].standard_error).epsilon(1e-6));
    CHECK_FALSE(any_nan(best, r));
}

TEST_CASE("two parameters of which only the product matters") {
    const Problem problem = product_only();
    const Fit best = fit(problem, {});
    const Report r = report(problem, best);
    CHECK(best.termination == Termination::converged);
    CHECK(std::isinf(r.estimates[0].standard_error));
    CHECK(std::isinf(r.estimates[1].standard_error));
    CHECK(std::isfinite(r.estimates[2].standard_error));
    REQUIRE(r.flat.size() == 1);
    CHECK_THAT(
        r.flat[0].text,
        Contains("the data do not fix eta and xi separately: raising eta by 1 % and lowering xi by 1 %"));
    CHECK(std::abs(r.flat[0].change[0]) == Approx(1.0).epsilon(1e-6));
    CHECK(r.flat[0].change[1] == Approx(-r.flat[0].change[0]).epsilon(1e-6));
    CHECK(r.correlation(0, 1) == 0.0);
    CHECK_FALSE(any_nan(best, r));
    // what depends on the product alone has an error, what does not has none
    const double eta = best.values[0], xi = best.values[1];
    Eigen::MatrixXd gradients(2, 3);
    gradients << xi, eta, 0.0, 1.0, 0.0, 0.0;
    const Eigen::VectorXd errors = propagated(r, gradients);
    // a straight line through x = 0..11: error of the slope 1/sqrt(sum (x - mean)^2) = 1/sqrt(143)
    CHECK(errors[0] == Approx(1.0 / std::sqrt(143.0)).epsilon(1e-6));
    CHECK(std::isinf(errors[1]));
}

TEST_CASE("exact data: chi2 is 0 and nothing complains") {
    for (const bool known : {true, false}) {
        Problem problem = toy::decay();
        problem.sigma_known = known;
        const Fit best = fit(problem, {});
        CAPTURE(known, best.reason);
        CHECK(best.termination == Termination::converged);
        CHECK(best.chi2 < 1e-24); // (1e-16 of values near 1)/0.1, squared, 40 of them
        CHECK(best.values[0] == Approx(2.0).epsilon(1e-12));
        const Report r = report(problem, best);
        CHECK_FALSE(any_nan(best, r));
        CHECK_FALSE(says(r, "not at a stationary point"));
        CHECK(r.estimates[0].standard_error < (known ? 0.1 : 1e-12));
    }
}

TEST_CASE("as many parameters as data: no errors without sigmas") {
    Problem problem = toy::line({1.0, 3.0});
    const Fit best = fit(problem, {});
    CHECK(report(problem, best).estimates[0].standard_error == Approx(1.0).epsilon(1e-12));
    problem.sigma_known = false;
    const Report r = report(problem, best);
    CHECK(std::isinf(r.estimates[0].standard_error));
    CHECK(r.flat.empty());
    CHECK(says(r, "errors unknown: as many parameters as data points"));
    CHECK_FALSE(any_nan(best, r));
    const std::string text = to_text(problem, best, r);
    CHECK_THAT(text, Contains("a          1, error unknown"));
    CHECK_THAT(text, !Contains("infinite") && !Contains("inf]"));
}

TEST_CASE("overflow on the way is a bad place, not an end") {
    Problem problem = toy::decay(40, 3);
    problem.parameters[1] = toy::parameter("b", 0.02); // linear: steps to negative b give exp(250) and more
    problem.parameters[2].start = 30.0;
    const Fit best = fit(problem, {});
    CHECK(best.objective == Approx(fit(toy::decay(40, 3), {}).objective).epsilon(1e-9));
}

TEST_CASE("the search for NaN finds one") {
    const Problem problem = toy::decay(40, 3);
    Fit best = fit(problem, {});
    Report r = report(problem, best);
    CHECK_FALSE(any_nan(best, r));
    r.estimates[1].low = std::numeric_limits<double>::quiet_NaN();
    CHECK(any_nan(best, r));
}

TEST_CASE("out of memory is not taken for a bad point") {
    Problem problem = toy::decay(40, 3);
    int left = 5;
    problem.evaluate = [inner = problem.evaluate, &left](auto p, auto r, Eigen::MatrixXd* jacobian) {
        if (--left == 0)
            throw std::bad_alloc();
        inner(p, r, jacobian);
    };
    Method method;
    method.threads = 1;
    CHECK_THROWS_AS(fit(problem, method), std::bad_alloc);
}

// --- Every way to ask for what cannot be done is an InputError that names it

namespace {

template<class Change>
Problem changed(Change change) {
    Problem problem = toy::decay();
    change(problem);
    return problem;
}

} // namespace

TEST_CASE("a problem is checked") {
    const auto refused = [](auto change, const std::string& words) {
        CHECK_THROWS_WITH(validate(changed(change)), Contains(words));
        CHECK_THROWS_AS(validate(changed(change)), InputError);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    refused([](Problem& p) { p.parameters[1].name = ""; }, "parameter 1 has no name");
    refused([](Problem& p) { p.parameters[2].name = "a"; }, "two parameters are called \"a\"");
    refused([](Problem& p) { p.parameters[0].lower = 3.0, p.parameters[0].upper = 2.0; },
            "bounds of a are reversed");
    refused([](Problem& p) { p.parameters[0].lower = p.parameters[0].upper = 1.0; },
            "both bounds of a are 1");
    refused([](Problem& p) { p.parameters[0].lower = 2.0; }, "a starts at 1, outside its bounds");
    refused([&](Problem& p) { p.parameters[0].upper = nan; }, "a bound of a is not a number");
    refused([&](Problem& p) { p.parameters[0].start = inf; }, "the start of a is not a finite number");
    refused([](Problem& p) { p.parameters[1].start = 0.0; }, "b is searched in the logarithm");
    refused([](Problem& p) { p.parameters[1].lower = -1.0; }, "lower bound must be above 0, not -1");
    refused([](Problem& p) { p.parameters[1].scale = -1.0; }, "the scale of b is -1");
    refused([](Problem& p) { p.parameters[2].tied_to = "z"; }, "c is tied to z, which is no parameter");
    refused([](Problem& p) { p.parameters[2].tied_to = "c"; }, "not free itself");
    refused([](Problem& p) { p.parameters[2].tied_to = "a", p.parameters[0].fixed = true; },
            "not free itself");
    refused([](Problem& p) { p.parameters[2].tied_to = "a", p.parameters[2].fixed = true; },
            "both fixed and tied");
    refused([&](Problem& p) { p.parameters[2].tied_to = "a", p.parameters[2].tie_factor = nan; },
            "factor that ties c");
    refused([](Problem& p) { p.residuals = 2; }, "2 data points cannot fix 3 parameters");
    refused(
        [](Problem& p) {
            p.residuals = 0;
            for (auto& q : p.parameters)
                q.fixed = true;
        },
        "0 data points");
    refused([](Problem& p) { p.evaluate = nullptr; }, "no function");
    CHECK_NOTHROW(validate(toy::decay()));
}

TEST_CASE("a method is checked") {
    const auto refused = [](auto change, const std::string& words) {
        Method method;
        change(method);
        CHECK_THROWS_WITH(fit(toy::decay(), method), Contains(words));
        CHECK_THROWS_AS(fit(toy::decay(), method), InputError);
    };
    refused([](Method& m) { m.tolerance = 0.0; }, "tolerance 0");
    refused([](Method& m) { m.max_evaluations = 0; }, "max_evaluations 0");
    refused([](Method& m) { m.starts = 0; }, "starts 0");
    refused([](Method& m) { m.spread = 1.0; }, "spread 1");
    refused([](Method& m) { m.loss_width = -1.0; }, "loss_width -1");
    refused(
        [](Method& m) {
            m.done = {{3, {1, 1, 1}, {1, 1, 1}, 1.0, "converged: x", 1}};
        },
        "belongs to another fit");
    refused([](Method& m) { m.done = {{0, {1}, {1}, 1.0, "converged: x", 1}}; }, "belongs to another fit");
    for (const Algorithm a : {Algorithm::mlsl, Algorithm::crs, Algorithm::isres, Algorithm::direct_l})
        refused([a](Method& m) { m.algorithm = a; },
                to_string(a) + " searches the whole box of the bounds, so a needs");
}

TEST_CASE("ties and fixed parameters make all values") {
    Problem problem = toy::decay();
    problem.parameters[0].tied_to = "c";
    problem.parameters[0].tie_factor = 2.0;
    problem.parameters[1].fixed = true;
    CHECK(free_parameters(problem) == std::vector<std::size_t>{2});
    CHECK(all_values(problem, std::vector<double>{5.0}) == std::vector<double>{10.0, 1.0, 5.0});
}
