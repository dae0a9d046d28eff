// 95 % intervals hold the true value in 95 % of cases: synthetic fits of a nonlinear problem.

#include "catch2/catch.hpp"
#include "toy_problems.hpp"

#include <algorithm>

using namespace rodwake::fitting;

namespace {

struct Setting {
    int fits = 200;
    bool sigma_known = true;
    Loss loss = Loss::squares;
    double claimed = 1.0;  ///< sigma claimed, of the true one
    double outliers = 0.0; ///< fraction of data with ten times the noise
};

/// Problem of `seed`, noise and all.
Problem made(const Setting& setting, std::uint64_t seed) {
    Problem problem = toy::decay(30, 0);
    problem.sigma_known = setting.sigma_known;
    std::vector<double> noise;
    rodwake::RandomStream random(seed, 77);
    for (std::size_t i = 0; i < problem.residuals; ++i)
        noise.push_back(toy::normal(random) * (random.uniform() < setting.outliers ? 10.0 : 1.0));
    problem.evaluate = [noise, by = 1.0 / setting.claimed,
                        inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
        inner(p, r, jacobian);
        for (std::size_t i = 0; i < noise.size(); ++i)
            r[static_cast<Eigen::Index>(i)] = by * (r[static_cast<Eigen::Index>(i)] - noise[i]);
        if (jacobian)
            *jacobian *= by;
    };
    return problem;
}

/// Fraction of fits whose interval holds the true value, of each parameter.
std::array<double, 3> coverage(const Setting& setting) {
    const std::array<double, 3> truth{2.0, 1.5, 0.5};
    std::array<double, 3> held{};
    Method method;
    method.loss = setting.loss;
    for (int i = 0; i < setting.fits; ++i) {
        const Problem problem = made(setting, 1000 + static_cast<std::uint64_t>(i));
        const Report r = report(problem, fit(problem, method));
        for (std::size_t k = 0; k < 3; ++k)
            held[k] +=
                (r.estimates[k].low <= truth[k] && truth[k] <= r.estimates[k].high) / double(setting.fits);
    }
    return held;
}

/// Four standard deviations of a binomial count of 95 %: 0.062 of 200, 0.028 of 1000.
double slack(int fits) { return 4.0 * std::sqrt(0.95 * 0.05 / fits); }

} // namespace

TEST_CASE("intervals hold the truth in 95 % of 200 fits") {
    for (const bool known : {true, false})
        for (const double held : coverage({.sigma_known = known}))
            CHECK(std::abs(held - 0.95) < slack(200));
}

TEST_CASE("the count of intervals sees sigmas that are half the true ones") {
    // 1.96/2 standard deviations hold 67 %
    for (const double held : coverage({.claimed = 0.5}))
        CHECK(std::abs(held - 0.67) < 0.15);
    for (const double held : coverage({.sigma_known = false, .claimed = 0.5}))
        CHECK(std::abs(held - 0.95) < slack(200));
}

TEST_CASE("intervals hold the truth in 93 to 97 % of 1000 fits", "[.][long]") {
    for (const bool known : {true, false})
        for (const double held : coverage({.fits = 1000, .sigma_known = known})) {
            CAPTURE(known);
            CHECK(held > 0.93);
            CHECK(held < 0.97);
        }
}

TEST_CASE("robust losses hold the truth among outliers", "[.][long]") {
    for (const Loss loss : {Loss::huber, Loss::cauchy})
        for (const double held : coverage({.fits = 1000, .loss = loss, .outliers = 0.07})) {
            CAPTURE(static_cast<int>(loss));
            // Huber's errors are of first order in the number of data, here 30
            CHECK(held > 0.90);
            CHECK(held < 0.98);
        }
    for (const double held : coverage({.fits = 200, .outliers = 0.07}))
        CHECK(held < 0.85);
}
