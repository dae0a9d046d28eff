// By what factor data exceed a prediction.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "synthetic_profiles.hpp"

using namespace rodwake::fitting;
using namespace fitting_test;

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
