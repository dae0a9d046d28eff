// The report as a page.

#include "catch2/catch.hpp"
#include "toy_problems.hpp"

#include <algorithm>

using namespace rodwake::fitting;
using Catch::Matchers::Contains;

namespace {

/// Straight line with a bounded, a logarithmic, a tied and a fixed parameter.
Problem of_all_kinds() {
    Problem problem = toy::line({1.2, 2.9, 5.1, 6.8, 9.3, 10.7});
    problem.parameters = {toy::bounded("intercept", 0.5, -10.0, 10.0), toy::positive("slope", 1.0),
                          toy::parameter("half", 0.0), toy::parameter("gravity", 9.81)};
    problem.parameters[1].lower = 0.01;
    problem.parameters[2].tied_to = "slope";
    problem.parameters[2].tie_factor = 0.5;
    problem.parameters[3].fixed = true;
    problem.evaluate = [inner = problem.evaluate](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                                                  Eigen::MatrixXd* jacobian) {
        Eigen::MatrixXd two(r.size(), 2);
        inner(p.first(2), r, jacobian ? &two : nullptr);
        if (jacobian)
            jacobian->leftCols(2) = two;
    };
    return problem;
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
    CHECK(text.find("nan") == std::string::npos);
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
        CHECK((at == 0 || text[at - 1] != ' ')); // no spaces at ends of lines
}

TEST_CASE("the page points at strong correlations, and lists diagnostics") {
    Problem problem = toy::line({1.2, 2.9, 5.1, 6.8, 9.3, 10.7});
    problem.evaluate = [inner = problem.evaluate](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                                                  Eigen::MatrixXd* jacobian) {
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
        problem.evaluate = [=](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                               Eigen::MatrixXd* jacobian) {
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
