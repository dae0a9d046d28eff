// What a fit says in numbers: errors, intervals, correlations. Straight lines have everything in closed
// form.

#include "toy_problems.hpp"

#include "rodwake/measure/statistics.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace rodwake::fitting;
using Catch::Matchers::Contains;
using toy::reported;
using toy::says;
using toy::times;
using toy::ys;

namespace {

/// Of a + b x through ys at x = 0..5 with sigma 1: sum x = 15, sum x^2 = 55, n = 6, determinant 105.
struct LineByHand {
    double b = (6.0 * (2.9 + 2 * 5.1 + 3 * 6.8 + 4 * 9.3 + 5 * 10.7) - 15.0 * 36.0) / 105.0;
    double a = (36.0 - 15.0 * b) / 6.0;
    double error_a = std::sqrt(55.0 / 105.0), error_b = std::sqrt(6.0 / 105.0);
    double covariance = -15.0 / 105.0, chi2 = 0.0;

    LineByHand() {
        for (std::size_t i = 0; i < ys.size(); ++i)
            chi2 += std::pow(a + b * static_cast<double>(i) - ys[i], 2);
    }
};

} // namespace

// Tolerances of 1e-12: Levenberg-Marquardt ends at rounding errors, and the line's condition number is
// about 10.
TEST_CASE("a straight line's errors, covariance, chi2 and intervals are those of the textbook") {
    const LineByHand hand;
    const Report r = reported(toy::line(ys));
    CHECK(r.estimates[0].value == Approx(hand.a).epsilon(1e-12));
    CHECK(r.estimates[1].value == Approx(hand.b).epsilon(1e-12));
    CHECK(r.estimates[0].standard_error == Approx(hand.error_a).epsilon(1e-12));
    CHECK(r.estimates[1].standard_error == Approx(hand.error_b).epsilon(1e-12));
    CHECK(r.covariance(0, 1) == Approx(hand.covariance).epsilon(1e-12));
    CHECK(r.correlation(1, 0) == Approx(hand.covariance / (hand.error_a * hand.error_b)).epsilon(1e-12));
    CHECK(r.correlation(0, 0) == 1.0);
    CHECK(r.chi2 == Approx(hand.chi2).epsilon(1e-12));
    CHECK(r.dof == 4);
    CHECK(r.rank == 2);
    CHECK(r.probability == rodwake::measure::chi2_probability(r.chi2, 4));
    CHECK(r.estimates[1].high - hand.b == Approx(1.959964 * hand.error_b).epsilon(1e-12));
    CHECK(hand.b - r.estimates[1].low == Approx(1.959964 * hand.error_b).epsilon(1e-12));
    CHECK(r.error_factor == 1.0);
    CHECK(r.same_optimum == 1);
}

TEST_CASE("without sigmas errors come from the scatter, intervals from Student's t") {
    const LineByHand hand;
    Problem problem = toy::line(ys);
    problem.sigma_known = false;
    const Report r = reported(problem);
    const double factor = std::sqrt(hand.chi2 / 4.0);
    CHECK(r.error_factor == Approx(factor).epsilon(1e-12));
    CHECK(r.estimates[1].standard_error == Approx(factor * hand.error_b).epsilon(1e-12));
    // t of 4 degrees of freedom, 97.5 %: 2.776445 in every table
    CHECK(r.estimates[1].high - hand.b == Approx(2.776445 * factor * hand.error_b).epsilon(1e-6));
    CHECK(says(r, "errors from the scatter"));
    CHECK(reported(times(problem, 50.0)).estimates[1].standard_error ==
          Approx(r.estimates[1].standard_error).epsilon(1e-10));
}

TEST_CASE("the scale of the search changes no error") {
    Problem scaled = toy::decay(40, 3);
    scaled.parameters[0].scale = 1e-3;
    scaled.parameters[1].scale = 40.0;
    const Report a = reported(toy::decay(40, 3)), b = reported(scaled);
    for (std::size_t k = 0; k < 3; ++k) { // minima agree to 1e-6 standard errors
        CHECK(a.estimates[k].standard_error == Approx(b.estimates[k].standard_error).epsilon(1e-6));
        CHECK(a.estimates[k].high == Approx(b.estimates[k].high).epsilon(1e-6));
    }
}

TEST_CASE("errors of a logarithmic parameter are symmetric in the logarithm") {
    const Report r = reported(toy::decay(40, 3));
    const ParameterEstimate& b = r.estimates[1];
    CHECK(b.value / b.low == Approx(b.high / b.value).epsilon(1e-12));
    CHECK(std::log(b.high / b.value) == Approx(1.959964 * b.standard_error / b.value).epsilon(1e-12));
    Problem linear = toy::decay(40, 3);
    linear.parameters[1].transform = Transform::linear;
    CHECK(reported(linear).estimates[1].standard_error == Approx(b.standard_error).epsilon(1e-6));
}

TEST_CASE("tied parameters follow, with their errors") {
    Problem problem = toy::decay(40, 3);
    problem.parameters[2].tied_to = "a";
    problem.parameters[2].tie_factor = -0.25;
    const Report r = reported(problem);
    const ParameterEstimate &a = r.estimates[0], &c = r.estimates[2];
    CHECK(r.free == std::vector<std::size_t>{0, 1});
    CHECK(c.value == -0.25 * a.value);
    CHECK(c.standard_error == 0.25 * a.standard_error);
    CHECK(c.low == -0.25 * a.high);
    CHECK(c.high == -0.25 * a.low);
    CHECK_FALSE(c.free);
    // d c/d p = 1 alone is what the tie makes of a
    Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(1, 3);
    gradient(0, 2) = 1.0;
    CHECK(propagated(r, gradient)[0] == Approx(c.standard_error).epsilon(1e-12));
}

TEST_CASE("a parameter on a bound has no error, the others theirs with it fixed") {
    Problem problem = toy::line(ys), held = problem;
    problem.parameters[0].lower = 2.0;
    problem.parameters[0].start = 3.0;
    held.parameters[0].fixed = true;
    held.parameters[0].start = 2.0;
    const Report r = reported(problem), expected = reported(held);
    CHECK(r.estimates[0].at_lower);
    CHECK_FALSE(r.estimates[0].at_upper);
    CHECK(r.estimates[0].standard_error == 0.0);
    CHECK(r.estimates[1].standard_error == Approx(1.0 / std::sqrt(55.0)).epsilon(1e-12));
    CHECK(r.estimates[1].value == Approx(expected.estimates[1].value).epsilon(1e-12));
    CHECK(r.dof == 4); // a was fitted too: the data chose the bound
    CHECK(r.correlation.isIdentity(0.0));
    CHECK(says(r, "a is on its lower bound 2"));
    CHECK(r.flat.empty());
    problem.parameters[0].lower = -10.0;
    problem.parameters[0].start = problem.parameters[0].upper = 0.5;
    CHECK(reported(problem).estimates[0].at_upper);
}

// chi2 along a, b fitted: ((a - a0)^2 - (bound - a0)^2)/error^2 above that on the bound.
TEST_CASE("a parameter on a bound has a one-sided interval, up to where chi2 has risen by 3.84") {
    const LineByHand hand;
    const auto reach = [&](double bound, double rise) {
        return std::sqrt(std::pow(bound - hand.a, 2) + rise * std::pow(hand.error_a, 2));
    };
    for (const bool log : {false, true}) {
        Problem problem = toy::line(ys);
        problem.parameters[0] = toy::bounded("a", 3.0, 2.0, 1e9);
        problem.parameters[0].transform = log ? Transform::log : Transform::linear;
        const Report r = reported(problem);
        CHECK(r.estimates[0].low == 2.0);
        CHECK(r.estimates[0].high == Approx(hand.a + reach(2.0, 3.841459)).epsilon(1e-6));
        CHECK(says(r, "the data allow values up to"));
        problem.parameters[0] =
            toy::bounded("a", 0.2, 1e-9, 0.5); // far below what is allowed in the logarithm
        problem.parameters[0].transform = log ? Transform::log : Transform::linear;
        const ParameterEstimate upper = reported(problem).estimates[0];
        CHECK(upper.high == 0.5);
        CHECK(upper.low == 1e-9);
    }
    Problem problem = toy::line(ys);
    problem.parameters[0] = toy::bounded("a", 0.2, -1e9, 0.5);
    CHECK(reported(problem).estimates[0].low == Approx(hand.a - reach(0.5, 3.841459)).epsilon(1e-6));
    problem.parameters[0] = toy::bounded("a", 2.05, 2.0, 2.1);
    const Report r = reported(problem);
    CHECK(r.estimates[0].high == 2.1);
    CHECK(says(r, "the data do not constrain it: any value between its bounds fits within 95 %"));
    CHECK_THAT(to_text(problem, fit(problem, {}), r), Contains("[2, 2.1]"));
}

TEST_CASE("the limit of a parameter at the end of the logarithm is found however far it is") {
    Problem problem = toy::decay(40, 3);
    problem.parameters[2] = toy::bounded("c", 0.1, 1e-6, 1e6); // the data want c below 0
    problem.parameters[2].transform = Transform::log;
    problem.evaluate = [inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
        inner(p, r, jacobian);
        r.array() += 7.0; // of sigma 0.1: the constant is 0.5 - 0.7
    };
    const Fit best = fit(problem, {});
    const Report said = report(problem, best);
    INFO(to_text(problem, best, said));
    REQUIRE(said.estimates[2].at_lower);
    Problem held = problem;
    held.parameters[2].fixed = true;
    held.parameters[2].start = said.estimates[2].high;
    CHECK(fit(held, {}).objective - best.objective == Approx(3.841459).epsilon(1e-5));
    CHECK(said.estimates[2].high > 1e-3);
    const ProfileLikelihood profile = profile_likelihood(problem, {}, best, 2);
    CHECK(profile.high.value() == Approx(said.estimates[2].high).epsilon(1e-6));
    CHECK(profile.value.size() > 5);
}

// Huber's estimator on normal data of known sigma: variance E psi^2/(E psi')^2 times that of the mean. With
// width w: E psi' = erf(w/sqrt 2), E psi^2 = erf(w/sqrt 2) - w sqrt(2/pi) exp(-w^2/2) + w^2 erfc(w/sqrt 2).
TEST_CASE("errors with a robust loss are Huber's") {
    std::vector<double> y;
    rodwake::RandomStream random(11);
    for (int i = 0; i < 4000; ++i)
        y.push_back(toy::normal(random));
    const double w = 1.0, inside = std::erf(w / std::sqrt(2.0));
    const double psi2 =
        inside - w * std::sqrt(2.0 / std::numbers::pi) * std::exp(-0.5 * w * w) + w * w * (1.0 - inside);
    Method method;
    method.loss = Loss::huber;
    method.loss_width = w;
    const Report r = reported(toy::line(y), method);
    // the factor of 4000 deviates scatters by about 1 %; 4 of that
    CHECK(r.error_factor == Approx(std::sqrt(psi2) / inside).epsilon(0.04));
    CHECK(r.error_factor > 1.0);
    CHECK(says(r, "robust loss (huber, width 1)"));
}

TEST_CASE("propagated errors are those of the covariance") {
    const Report r = reported(toy::decay(40, 3));
    Eigen::MatrixXd g(3, 3);
    g << 1.0, 0.0, 0.0, 0.3, -2.0, 1.5, 0.0, 0.0, 0.0;
    const Eigen::VectorXd errors = propagated(r, g);
    CHECK(errors[0] == Approx(r.estimates[0].standard_error).epsilon(1e-12));
    CHECK(errors[1] == Approx(std::sqrt((g.row(1) * r.covariance * g.row(1).transpose())(0))).epsilon(1e-10));
    CHECK(errors[2] == 0.0);
}

TEST_CASE("data given twice and worth half each say what they say once") {
    const Problem once = toy::decay(40, 3);
    Problem twice = once;
    twice.residuals = 80;
    twice.independent = 0.5;
    twice.evaluate = [once](auto p, auto r, Eigen::MatrixXd* jacobian) {
        Eigen::VectorXd half(40);
        Eigen::MatrixXd slopes(40, static_cast<Eigen::Index>(p.size()));
        once.evaluate(p, half, jacobian ? &slopes : nullptr);
        r << half, half;
        r *= std::sqrt(0.5); // sigma enlarged by 1/sqrt(independent)
        if (jacobian)
            *jacobian << std::sqrt(0.5) * slopes, std::sqrt(0.5) * slopes;
    };
    const Report a = report(once, fit(once, {})), b = report(twice, fit(twice, {}));
    CHECK(b.dof == a.dof);
    CHECK(b.chi2 == Approx(a.chi2).epsilon(1e-12));
    for (std::size_t j = 0; j < a.estimates.size(); ++j)
        CHECK(b.estimates[j].standard_error ==
              Approx(a.estimates[j].standard_error).epsilon(1e-6)); // both stop within 1e-8 of the minimum
    twice.independent = 1.0;
    CHECK(report(twice, fit(twice, {})).dof == a.dof + 40);
}

TEST_CASE("an impossible worth of the data is refused") {
    Problem problem = toy::decay();
    for (const double wrong : {0.0, -1.0, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
        problem.independent = wrong;
        CHECK_THROWS_WITH(validate(problem), Catch::Matchers::Contains("independent"));
    }
}

TEST_CASE("what follows from parameters has their errors, an unknown one, or an infinite one") {
    const LineByHand hand;
    const Report r = reported(toy::line(ys));
    // the line at x = 2: var a + 4 var b + 4 cov
    const rodwake::Estimate at2 = derived(r, hand.a + 2.0 * hand.b, {{"a", 1.0}, {"b", 2.0}});
    CHECK(at2.error ==
          Approx(std::sqrt(55.0 / 105.0 + 4.0 * 6.0 / 105.0 + 4.0 * hand.covariance)).epsilon(1e-12));
    CHECK(at2.count == 6);
    CHECK(fitted_value(r, "b") == r.estimates[1].value);
    CHECK_FALSE(fitted_value(r, "c").has_value());

    Problem held = toy::line(ys); // a is held by a bound: b has an error, what follows from both has none
    held.parameters[0].lower = 2.0;
    held.parameters[0].start = 3.0;
    const Report bound = reported(held);
    CHECK(at_bound(bound, bound.estimates[0]));
    CHECK_FALSE(has_error(bound, bound.estimates[0]));
    CHECK_FALSE(derived(bound, 1.0, {{"a", 1.0}, {"b", 2.0}}).known());
    CHECK(derived(bound, 1.0, {{"b", 2.0}}).error == Approx(2.0 / std::sqrt(55.0)).epsilon(1e-12));

    Problem fixed = toy::line(ys);
    fixed.parameters[0].fixed = true;
    CHECK_FALSE(derived(reported(fixed), 1.0, {{"a", 1.0}}).known());

    Problem flat = toy::line(ys); // residuals of b alone
    flat.evaluate = [inner = flat.evaluate](auto p, auto residual, Eigen::MatrixXd* jacobian) {
        const std::vector<double> without{0.0, p[1]};
        inner(without, residual, jacobian);
        if (jacobian)
            jacobian->col(0).setZero();
    };
    const Report loose = reported(flat);
    CHECK(derived(loose, 1.0, {{"a", 1.0}}).not_fixed());
    CHECK_FALSE(derived(loose, 1.0, {{"b", 1.0}}).not_fixed());

    Problem exact = toy::line({1.0, 3.0}); // as many values as parameters, no sigma: unknown, not "not fixed"
    exact.sigma_known = false;
    const rodwake::Estimate unknown = derived(reported(exact), 1.0, {{"b", 1.0}});
    CHECK_FALSE(unknown.known());
    CHECK_FALSE(unknown.not_fixed());
}

// --- The report as a page

namespace {

/// Straight line with a bounded, a logarithmic, a tied and a fixed parameter.
Problem of_all_kinds() {
    Problem problem = toy::line(toy::ys);
    problem.parameters = {toy::bounded("intercept", 0.5, -10.0, 10.0), toy::positive("slope", 1.0)};
    problem.parameters[1].lower = 0.01;
    problem = toy::with_idle(problem, {.name = "half", .tied_to = "slope", .tie_factor = 0.5});
    return toy::with_idle(problem, {.name = "gravity", .start = 9.81, .fixed = true});
}

std::string page(const Problem& problem, const Method& method = {}) {
    const Fit best = fit(problem, method);
    return to_text(problem, best, report(problem, best));
}

} // namespace

TEST_CASE("the page of a fit") {
    Method method;
    method.starts = 12;
    const std::string text = page(of_all_kinds(), method);
    // a + b x through six points by hand: a 1.114 +- 0.724, b 1.954 +- 0.239
    CHECK_THAT(text, Contains("  parameter  value +- error  95 % interval       start  bounds\n"
                              "  intercept  1.11 +- 0.72    [-0.30423, 2.5328]  0.5    [-10, 10]\n"
                              "  slope      1.95 +- 0.24    [1.5377, 2.4837]    1      >= 0.01    log\n"
                              "  half       0.98 +- 0.12    [0.76885, 1.2419]                     0.5 slope\n"
                              "  gravity    9.81                                9.81              fixed\n"));
    CHECK_THAT(text, Contains("\nCorrelations\n"
                              "             intercept  slope\n"
                              "  intercept  1.000\n"
                              "  slope      -0.826     1.000\n"));
    CHECK_THAT(
        text,
        Contains("chi2 = 0.243429, 6 data, 4 degrees of freedom, chi2/dof = 0.06086, probability 0.993\n"
                 "converged after "));
    CHECK_THAT(text, Contains("Starts: 12 of 12 ended at the best objective\n"
                              "  start  objective"));
    CHECK_THAT(text, Contains("  and 2 more\n"));
    CHECK_THAT(text, !Contains("nan"));
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
        CHECK((at == 0 || text[at - 1] != ' ')); // no spaces at ends of lines
}

TEST_CASE("the page points at strong correlations, and lists diagnostics") {
    Problem problem = toy::line(toy::ys);
    problem.evaluate = [inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
        inner(std::vector<double>{p[0] + 20.0 * p[1], p[1]}, r, jacobian);
        if (jacobian)
            jacobian->col(1) += 20.0 * jacobian->col(0);
    };
    CHECK_THAT(page(problem), Contains("a and b are strongly correlated (-0.99"));
    problem.sigma_known = false;
    Method robust;
    robust.loss = Loss::cauchy;
    const std::string text = page(problem, robust);
    CHECK_THAT(text, Contains("Remarks\n  - robust loss (cauchy, width 1.5)"));
    CHECK_THAT(text, Contains("objective of the loss = "));
    CHECK_THAT(text, !Contains("probability"));
}

TEST_CASE("values have as many digits as their errors allow") {
    const auto line_of = [](double level, double factor) {
        Problem problem;
        problem.parameters = {toy::parameter("p", level)};
        problem.residuals = 4;
        problem.evaluate = [=](auto p, auto r, Eigen::MatrixXd* jacobian) {
            r.setConstant(factor * (p[0] - level));
            if (jacobian)
                jacobian->setConstant(factor);
        };
        const std::string text = page(problem);
        const std::size_t row = text.find("\n  p") + 1;
        return text.substr(row, text.find('[', row) - row);
    };
    CHECK_THAT(line_of(123.456, 1.0), Contains("123.46 +- 0.50"));
    CHECK_THAT(line_of(123.456, 1e-3), Contains("123 +- 500"));
    CHECK_THAT(line_of(1.5e12, 1e-6), Contains("1.50000000e+12 +- 5.0e+05"));
    CHECK_THAT(line_of(-2.5e-9, 1e12), Contains("-2.50000e-09 +- 5.0e-13"));
    CHECK_THAT(line_of(0.0, 100.0), Contains("0.0000 +- 0.0050"));
}
