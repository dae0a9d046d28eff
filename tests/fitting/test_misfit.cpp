// Misfit and cross-validation: calibrated where the model is right, and loud where it is not.

#include "toy_problems.hpp"

#include "rodwake/fitting/misfit.hpp"

#include "catch2/catch.hpp"

#include <cmath>

using namespace rodwake;
using namespace rodwake::fitting;

namespace {

constexpr std::size_t points = 60;

/// A polynomial with this many coefficients through data of a line with some curvature, sigma 1.
Problem polynomial(std::size_t coefficients, double curvature, std::uint64_t seed) {
    RandomStream random(seed);
    std::vector<double> x, y;
    for (std::size_t i = 0; i < points; ++i) {
        x.push_back(2.0 * static_cast<double>(i) / (points - 1.0) - 1.0);
        y.push_back(1.0 + 2.0 * x[i] + curvature * x[i] * x[i] + toy::normal(random));
    }
    Problem problem;
    for (std::size_t k = 0; k < coefficients; ++k)
        problem.parameters.push_back(toy::parameter("c" + std::to_string(k), 0.5));
    problem.residuals = points;
    problem.evaluate = [x, y](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                              Eigen::MatrixXd* jacobian) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            r[row] = -y[i];
            for (std::size_t k = 0; k < p.size(); ++k) {
                r[row] += p[k] * std::pow(x[i], k);
                if (jacobian)
                    (*jacobian)(row, static_cast<Eigen::Index>(k)) = std::pow(x[i], k);
            }
        }
    };
    return problem;
}

double spoken(std::size_t coefficients, double curvature, bool sigma_known, int sets) {
    int count = 0;
    for (int set = 0; set < sets; ++set) {
        Problem problem = polynomial(coefficients, curvature, static_cast<std::uint64_t>(set + 1));
        problem.sigma_known = sigma_known;
        count += misfit(problem, fit(problem, {}), 7).describes() ? 0 : 1;
    }
    return static_cast<double>(count) / sets;
}

} // namespace

TEST_CASE("of the right model the misfit speaks in one of twenty sets of data") {
    constexpr int sets = 150;
    const double error = std::sqrt(0.05 * 0.95 / sets);
    for (const bool sigma_known : {true, false})
        CHECK(std::abs(spoken(2, 0.0, sigma_known, sets) - 0.05) < 3.0 * error); // binomial, three errors
}

TEST_CASE("of a wrong model the misfit speaks, whether sigmas are known or not") {
    for (const bool sigma_known : {true, false})
        CHECK(spoken(2, 5.0, sigma_known, 60) >= 0.95);
    const Problem problem = polynomial(2, 5.0, 1);
    const Misfit found = misfit(problem, fit(problem, {}), 7);
    CHECK(found.regions.size() == 3);
    CHECK(found.tests.size() == 4);
    CHECK_FALSE(found.worst.empty());
}

TEST_CASE("runs of one sign are told as they are: too long, too short, or as of noise") {
    const auto told = [](const std::vector<double>& data) {
        Problem problem = polynomial(1, 0.0, 1);
        problem.residuals = data.size();
        problem.evaluate = [data](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, // NOLINT
                                  Eigen::MatrixXd* jacobian) {
            r = Eigen::VectorXd::Map(data.data(), r.size()).array() - p[0];
            if (jacobian)
                jacobian->setConstant(-1.0);
        };
        for (const MisfitTest& test : misfit(problem, fit(problem, {}), 7).tests)
            if (test.name == "runs")
                return test.text;
        return std::string();
    };
    CHECK_THAT(told({1, 1, 1, 1, 1, 1, -1, -1, -1, -1, -1, -1}), Catch::Contains("too long"));
    CHECK_THAT(told({1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1}),
               Catch::Contains("too often, 12 runs where 7"));
    CHECK_THAT(told({1, 1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1}), Catch::Contains("as noise does"));
}

TEST_CASE("without a degree of freedom, and without noise, the misfit says nothing") {
    Problem problem = polynomial(2, 0.0, 1);
    problem.independent = 2.0 / points;
    CHECK_FALSE(misfit(problem, fit(problem, {}), 7).probability);
    const Problem exact = toy::decay(40, 0); // residuals are those of rounding
    CHECK(misfit(exact, fit(exact, {}), 7).describes());
}

TEST_CASE("a model that lacks a term foretells the data worse, one with a term too many hardly") {
    const Problem line = polynomial(2, 5.0, 1), parabola = polynomial(3, 5.0, 1),
                  more = polynomial(4, 5.0, 1);
    const auto foretold = [](const Problem& problem) {
        return *cross_validate(problem, {}, fit(problem, {}));
    };
    const CrossValidation wrong = foretold(line), right = foretold(parabola), rich = foretold(more);
    CHECK(right.blocks.size() == 8);
    CHECK(wrong.sum() <
          right.sum() - 10.0); // curvature 5: chi2 falls by 5^2 times the scatter of x^2, 0.3^2 points
    CHECK(std::abs(rich.sum() - right.sum()) < 4.0);
    Problem short_one = parabola;
    short_one.series = {{"first", "values", {0}}, {"rest", "values", {}}};
    for (std::size_t i = 1; i < points; ++i)
        short_one.series[1].residuals.push_back(i);
    CHECK(cross_validate(short_one, {}, fit(short_one, {}))->blocks.size() == 8); // one value stands alone
    CHECK_FALSE(cross_validate(parabola, {}, fit(parabola, {}), 1));
}
