// Means with errors and straight lines, against closed forms and against the scatter over many synthetic
// sets.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/statistics.hpp"
#include "support/normal.hpp"

#include <cmath>
#include <limits>
#include <vector>

using namespace rodwake;
using namespace rodwake::measure;

namespace {

using Row = std::vector<double>;

const double nan_value = std::numeric_limits<double>::quiet_NaN();

} // namespace

TEST_CASE("the mean of blocks of equal weight has the error s/sqrt(n)", "[statistics]") {
    const Row values = {1.0, 2.0, 4.0, 5.0}; // s^2 = 10/3
    const Estimate mean = mean_of_blocks(values);
    CHECK(mean.value == 3.0);
    CHECK(mean.error == Approx(std::sqrt(10.0 / 12.0)).epsilon(1e-15)); // round-off
    CHECK(mean.count == 4);
    const Estimate weighted = mean_of_blocks(values, Row{7.0, 7.0, 7.0, 7.0});
    CHECK(weighted.value == Approx(mean.value).epsilon(1e-15));
    CHECK(weighted.error == Approx(mean.error).epsilon(1e-15));
}

TEST_CASE("unequal weights follow the formula, and blocks without weight do not count", "[statistics]") {
    const Row values = {1.0, 100.0, 4.0}, weights = {1.0, 0.0, 2.0};
    const Estimate mean = mean_of_blocks(values, weights);
    CHECK(mean.value == Approx(3.0).epsilon(1e-15));
    // sum w^2 (v - m)^2 = 4 + 4, over 9, times 2/1
    CHECK(mean.error == Approx(std::sqrt(16.0 / 9.0)).epsilon(1e-15));
    CHECK(mean.count == 2);
}

TEST_CASE("an error that is not known is said to be unknown", "[statistics]") {
    const Estimate one = mean_of_blocks(Row{2.5});
    CHECK(one.value == 2.5);
    CHECK_FALSE(one.known());
    CHECK(one.count == 1);
    for (const Estimate& none : {mean_of_blocks(Row{}), mean_of_blocks(Row{3.0, 4.0}, Row{0.0, 0.0})}) {
        CHECK(none.value == 0.0);
        CHECK(none.count == 0);
        CHECK_FALSE(none.known());
    }
    CHECK(mean_of_blocks(Row{2.0, 2.0}).error == 0.0);
}

TEST_CASE("the error of a weighted mean is the scatter of the mean over many sets", "[statistics]") {
    RandomStream random(11);
    const Row weights = {1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0};
    const int sets = 4000;
    double squares = 0.0, errors = 0.0;
    for (int set = 0; set < sets; ++set) {
        Row values;
        for (const double w : weights) // a block of w samples scatters by 1/sqrt(w)
            values.push_back(normal(random) / std::sqrt(w));
        const Estimate mean = mean_of_blocks(values, weights);
        squares += mean.value * mean.value;
        errors += mean.error * mean.error;
    }
    // The formula is biased by sums of w^2 over (sum w)^2 = 0.1 less 1/12; both sums scatter by sqrt(2/4000).
    CHECK(errors / squares == Approx(1.0).margin(0.02 + 4.0 * std::sqrt(2.0 / sets)));
}

TEST_CASE("means refuse values, weights and lengths they cannot use", "[statistics]") {
    CHECK_THROWS_AS(mean_of_blocks(Row{1.0, nan_value}), InputError);
    CHECK_THROWS_AS(mean_of_blocks(Row{1.0, 2.0}, Row{1.0}), InputError);
    CHECK_THROWS_AS(mean_of_blocks(Row{1.0, 2.0}, Row{1.0, -1.0}), InputError);
    CHECK_THROWS_AS(mean_of_blocks(Row{1.0, 2.0}, Row{1.0, nan_value}), InputError);
}

TEST_CASE("successive values correlate as they were made to", "[statistics]") {
    RandomStream random(12);
    for (const double r : {0.0, 0.5, 0.8}) {
        Row values = {normal(random)};
        while (values.size() < 20000)
            values.push_back(r * values.back() + std::sqrt(1.0 - r * r) * normal(random));
        // scatter of a correlation from n values: sqrt((1 - r^2)/n) <= 0.0071; 4 of them
        CHECK(successive_correlation(values) == Approx(r).margin(0.03));
    }
    CHECK(successive_correlation(Row{1.0, -1.0, 1.0, -1.0}) == Approx(-0.75).epsilon(1e-15));
    CHECK(successive_correlation(Row{1.0, 2.0}) == 0.0);
    CHECK(successive_correlation(Row{2.0, 2.0, 2.0, 2.0}) == 0.0);
    CHECK_THROWS_AS(successive_correlation(Row{1.0, 2.0, nan_value}), InputError);
}

TEST_CASE("correlation widens the error, by a bounded factor", "[statistics]") {
    CHECK(correlation_factor(0.5) == Approx(std::sqrt(3.0)).epsilon(1e-15));
    CHECK(correlation_factor(-0.5) == 1.0);
    CHECK(correlation_factor(0.0) == 1.0);
    CHECK(correlation_factor(0.99) == correlation_factor(0.9));
    CHECK(correlation_factor(0.9) == Approx(std::sqrt(19.0)).epsilon(1e-14));
}

TEST_CASE("points on a line give the line, far from the origin too", "[statistics]") {
    for (const double shift : {0.0, 1e6}) {
        Row x, y, error;
        for (int i = 0; i < 5; ++i) {
            x.push_back(shift + i);
            y.push_back(2.0 - 3.0 * i);
            error.push_back(0.5 + 0.1 * i);
        }
        const LineFit fit = fit_line(x, y, error);
        CHECK(fit.slope.value == Approx(-3.0).epsilon(1e-13)); // round-off
        CHECK(fit.intercept.value == Approx(2.0 + 3.0 * shift).epsilon(1e-13));
        CHECK(fit.chi2 < 1e-12);
        CHECK(fit.dof == 3);
    }
}

TEST_CASE("a line fit agrees with the normal equations", "[statistics]") {
    const Row x = {0.0, 1.0, 2.0, 4.0}, y = {1.0, 0.5, 3.0, 4.0}, error = {1.0, 0.5, 1.0, 2.0};
    double s = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double w = 1.0 / (error[i] * error[i]);
        s += w, sx += w * x[i], sy += w * y[i], sxx += w * x[i] * x[i], sxy += w * x[i] * y[i];
    }
    const double determinant = s * sxx - sx * sx;
    const LineFit fit = fit_line(x, y, error);
    CHECK(fit.slope.value == Approx((s * sxy - sx * sy) / determinant).epsilon(1e-13));
    CHECK(fit.intercept.value == Approx((sxx * sy - sx * sxy) / determinant).epsilon(1e-13));
    CHECK(fit.slope.error == Approx(std::sqrt(s / determinant)).epsilon(1e-13));
    CHECK(fit.intercept.error == Approx(std::sqrt(sxx / determinant)).epsilon(1e-13));
    CHECK(fit.covariance == Approx(-sx / determinant).epsilon(1e-13));
    const LineFit through = fit_proportional(x, y, error);
    CHECK(through.slope.value == Approx(sxy / sxx).epsilon(1e-13));
    CHECK(through.slope.error == Approx(1.0 / std::sqrt(sxx)).epsilon(1e-13));
    CHECK(through.intercept.value == 0.0);
    CHECK(through.intercept.error == 0.0);
    CHECK(through.dof == 3);
}

TEST_CASE("errors and chi2 of a line fit are those of many synthetic sets", "[statistics]") {
    RandomStream random(13);
    const Row x = {1.0, 2.0, 3.0, 5.0, 8.0}, error = {0.3, 0.1, 0.2, 0.5, 0.4};
    const int sets = 4000;
    double slope2 = 0.0, intercept2 = 0.0, both = 0.0, chi2 = 0.0;
    int unlikely = 0;
    LineFit fit;
    for (int set = 0; set < sets; ++set) {
        Row y;
        for (std::size_t i = 0; i < x.size(); ++i)
            y.push_back(0.7 + 0.2 * x[i] + error[i] * normal(random));
        fit = fit_line(x, y, error);
        const double ds = fit.slope.value - 0.2, di = fit.intercept.value - 0.7;
        slope2 += ds * ds, intercept2 += di * di, both += ds * di, chi2 += fit.chi2;
        unlikely += chi2_probability(fit.chi2, fit.dof) < 0.1;
    }
    const double part = 4.0 * std::sqrt(2.0 / sets); // 4 standard errors of a variance
    CHECK(slope2 / sets == Approx(fit.slope.error * fit.slope.error).epsilon(part));
    CHECK(intercept2 / sets == Approx(fit.intercept.error * fit.intercept.error).epsilon(part));
    CHECK(both / sets == Approx(fit.covariance).epsilon(2.0 * part)); // a product scatters more
    CHECK(chi2 / sets == Approx(3.0).margin(4.0 * std::sqrt(6.0 / sets)));
    CHECK(unlikely / double(sets) == Approx(0.1).margin(4.0 * std::sqrt(0.09 / sets)));
}

TEST_CASE("the probability of chi2 has its closed forms", "[statistics]") {
    CHECK(chi2_probability(3.0, 2) == Approx(std::exp(-1.5)).epsilon(1e-14));
    CHECK(chi2_probability(4.0, 1) == Approx(std::erfc(std::sqrt(2.0))).epsilon(1e-14));
    CHECK(chi2_probability(6.0, 4) == Approx(4.0 * std::exp(-3.0)).epsilon(1e-14));
    CHECK(chi2_probability(0.0, 5) == 1.0);
    CHECK(chi2_probability(7.0, 0) == 1.0);
    CHECK(chi2_probability(1e9, 3) == 0.0);
    CHECK(chi2_probability(std::numeric_limits<double>::infinity(), 3) == 0.0);
    CHECK_THROWS_AS(chi2_probability(-1.0, 3), InputError);
    CHECK_THROWS_AS(chi2_probability(nan_value, 3), InputError);
    CHECK_THROWS_AS(chi2_probability(1.0, -1), InputError);
}

TEST_CASE("line fits refuse what does not fix a line", "[statistics]") {
    const Row x = {0.0, 1.0}, y = {1.0, 2.0}, error = {0.1, 0.1};
    CHECK(fit_line(x, y, error).dof == 0);
    for (const auto& fit : {fit_line, fit_proportional}) {
        CHECK_THROWS_AS(fit(Row{0.0}, Row{1.0}, Row{0.1}), InputError);
        CHECK_THROWS_AS(fit(Row{}, Row{}, Row{}), InputError);
        CHECK_THROWS_AS(fit(Row{2.0, 2.0}, y, error), InputError);
        CHECK_THROWS_AS(fit(x, y, Row{0.1, 0.0}), InputError);
        CHECK_THROWS_AS(fit(x, y, Row{0.1, -0.1}), InputError);
        CHECK_THROWS_AS(fit(x, y, Row{0.1, nan_value}), InputError);
        CHECK_THROWS_AS(fit(x, Row{1.0, nan_value}, error), InputError);
        CHECK_THROWS_AS(fit(x, y, Row{0.1}), InputError);
    }
    // Second point without weight beside the first, and the first at the origin: no slope through it.
    CHECK_THROWS_AS(fit_line(x, y, Row{1e-300, 1e300}), InputError);
    CHECK_THROWS_AS(fit_proportional(x, y, Row{1e-300, 1e300}), InputError);
}
