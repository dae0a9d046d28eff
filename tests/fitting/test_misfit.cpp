// Misfit and cross-validation: calibrated where the model is right, and loud where it is not.

#include "synthetic_profiles.hpp"
#include "toy_problems.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/fitting/misfit.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::fitting;
using namespace fitting_test;

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
    problem.evaluate = [x, y](auto p, auto r, Eigen::MatrixXd* jacobian) {
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

TEST_CASE("runs of one sign are reported as they are: too long, too short, or as of noise") {
    const auto verdict = [](const std::vector<double>& data) {
        Problem problem = polynomial(1, 0.0, 1);
        problem.residuals = data.size();
        problem.evaluate = [data](auto p, auto r, Eigen::MatrixXd* jacobian) {
            r = Eigen::VectorXd::Map(data.data(), r.size()).array() - p[0];
            if (jacobian)
                jacobian->setConstant(-1.0);
        };
        for (const MisfitTest& test : misfit(problem, fit(problem, {}), 7).tests)
            if (test.name == "runs")
                return test.text;
        return std::string();
    };
    CHECK_THAT(verdict({1, 1, 1, 1, 1, 1, -1, -1, -1, -1, -1, -1}), Catch::Contains("too long"));
    CHECK_THAT(verdict({1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1}),
               Catch::Contains("too often, 12 runs where 7"));
    CHECK_THAT(verdict({1, 1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1}), Catch::Contains("as noise does"));
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

// --- By what factor data exceed a prediction

namespace {

Profile data(std::vector<double> value, std::vector<double> sigma) {
    Profile profile;
    profile.name = "line";
    profile.place.resize(value.size());
    profile.value = std::move(value);
    profile.sigma = std::move(sigma);
    return profile;
}

} // namespace

TEST_CASE("data that are twice the prediction exceed it by 2") {
    const std::vector<double> model = {1.0, -2.0, 3.0};
    const ScaleFactor found = scale_factor(data({2.0, -4.0, 6.0}, {0.1, 0.2, 0.3}), model);
    CHECK(found.scale == Approx(2.0).epsilon(1e-15));
    CHECK(found.chi2 == Approx(100.0 + 100.0 + 100.0));
    // 1/sqrt(sum (m/sigma)^2)
    CHECK(found.standard_error == Approx(1.0 / std::sqrt(300.0)));
}

TEST_CASE("the error of the factor is the scatter of many") {
    rodwake::RandomStream random(7);
    const std::vector<double> model = {0.5, 1.0, 1.5, 2.0, -1.0};
    double sum = 0.0, squares = 0.0, claimed = 0.0;
    constexpr int many = 4000;
    for (int i = 0; i < many; ++i) {
        std::vector<double> value;
        for (const double m : model)
            value.push_back(1.7 * m + 0.2 * normal(random));
        const ScaleFactor one = scale_factor(data(value, std::vector<double>(5, 0.2)), model);
        sum += one.scale, squares += one.scale * one.scale;
        claimed = 1.0 / std::sqrt(8.5 / 0.04);
    }
    const double mean = sum / many, scatter = std::sqrt(squares / many - mean * mean);
    CHECK(std::abs(mean - 1.7) < 4.0 * claimed / std::sqrt(many));          // 4 standard errors
    CHECK(std::abs(scatter / claimed - 1.0) < 4.0 / std::sqrt(2.0 * many)); // of a standard deviation
}

TEST_CASE("an uncertain prediction makes the factor uncertain") {
    const std::vector<double> model = {1.0, 1.0};
    const Profile twice = data({2.0, 2.0}, {0.01, 0.01});
    // The whole prediction is uncertain by 10 %: so is the factor.
    const Eigen::MatrixXd root = Eigen::MatrixXd::Constant(2, 1, 0.1);
    CHECK(scale_factor(twice, model, &root).standard_error == Approx(0.2).epsilon(0.01));
}

TEST_CASE("the root of the covariance is as good as the covariance") {
    const std::vector<double> model = {1.0, -0.5, 2.0};
    const Profile some = data({1.1, -0.7, 2.6}, {0.1, 0.2, 0.4});
    Eigen::MatrixXd root(3, 2);
    root << 0.3, 0.1, -0.2, 0.4, 0.5, -0.1;
    const ScaleFactor plain = scale_factor(some, model), with = scale_factor(some, model, &root);
    // variance + g^T (G G^T) g, g = w (d - 2 s m)/sum w m^2, by hand
    const Eigen::Vector3d d(1.1, -0.7, 2.6), m(1.0, -0.5, 2.0), w(100.0, 25.0, 6.25);
    const Eigen::Vector3d g = w.cwiseProduct(d - 2.0 * with.scale * m) / w.dot(m.cwiseAbs2());
    const double variance = plain.standard_error * plain.standard_error + g.dot(root * root.transpose() * g);
    CHECK(with.standard_error == Approx(std::sqrt(variance)).epsilon(1e-12));
    CHECK(with.standard_error > 2.0 * plain.standard_error);
}

TEST_CASE("points that share data count less") {
    const std::vector<double> model = {1.0, -2.0, 3.0};
    Profile shared = data({2.0, -4.0, 6.0}, {0.1, 0.1, 0.1});
    const ScaleFactor all = scale_factor(shared, model);
    shared.independent = 0.25;
    const ScaleFactor quarter = scale_factor(shared, model);
    CHECK(quarter.scale == Approx(all.scale));
    CHECK(quarter.standard_error == Approx(2.0 * all.standard_error));
    CHECK(quarter.chi2 == Approx(all.chi2 / 4.0));
}

TEST_CASE("without sigma the error comes from the scatter") {
    const std::vector<double> model = {1.0, 1.0, 1.0, 1.0};
    CHECK(scale_factor(data({1.9, 2.1, 1.9, 2.1}, {}), model).standard_error ==
          Approx(0.1 * std::sqrt(4.0 / 3.0) / 2.0));
    CHECK_THROWS_AS(scale_factor(data({1.0}, {}), std::vector{0.0}), rodwake::InputError);
    CHECK_THROWS_AS(scale_factor(data({1.0}, {}), model), rodwake::InputError);
}
