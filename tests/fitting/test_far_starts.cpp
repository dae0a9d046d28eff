// Starts from which a search can leap over the minimum, or fall into another: what is found, and what is
// said.

#include "rodwake/fitting/report.hpp"
#include "swimming_pair.hpp"

#include "catch2/catch.hpp"

#include <algorithm>

using namespace rodwake;
using namespace rodwake::fitting;
using test::pair_problem;
using test::pair_truth;

namespace {

struct Found {
    double value = 0.0;
    Fit fit;
    Report report;

    bool says(const std::string& words) const {
        return std::ranges::any_of(report.diagnostics,
                                   [&](const std::string& r) { return r.find(words) != std::string::npos; });
    }
};

Found found(const std::string& name, double start, const Method& method = {}) {
    const Problem problem = pair_problem(name, start, 0.01);
    const Fit best = fit(problem, method);
    return {best.values[free_parameters(problem)[0]], best, report(problem, best)};
}

double chi2_at(const std::string& name, double value) {
    const Problem problem = pair_problem(name, value, 0.01);
    Eigen::VectorXd r(static_cast<Eigen::Index>(problem.residuals));
    problem.evaluate(all_values(problem, std::vector<double>{value}), r, nullptr);
    return r.squaredNorm();
}

Method with(Algorithm algorithm) {
    Method method;
    method.algorithm = algorithm;
    return method;
}

} // namespace

// From 3 chi2 falls all the way to 0 at alpha = 1, and beyond a barrier again towards alpha = 0: a first step
// of a factor 20 ends there. The values are exact to the solver's tolerance of 1e-10; required: 1e-6.
TEST_CASE("a search does not leap over the minimum that its start leads to") {
    CHECK(chi2_at("alpha", 5.0) > chi2_at("alpha", 3.0));
    CHECK(chi2_at("alpha", 3.0) > chi2_at("alpha", 1.5));
    CHECK(chi2_at("alpha", 0.2) > chi2_at("alpha", 1e-6));
    for (const Algorithm algorithm :
         {Algorithm::slsqp, Algorithm::lbfgs, Algorithm::mma, Algorithm::bobyqa, Algorithm::nelder_mead}) {
        CAPTURE(to_string(algorithm));
        const Found from3 = found("alpha", 3.0, with(algorithm));
        CHECK(from3.value == Approx(1.0).epsilon(1e-6));
        CHECK(from3.fit.termination == Termination::converged);
        CHECK(from3.fit.chi2 < 1e-10);
    }
    CHECK(found("alpha", 5.0).value == Approx(1.0).epsilon(1e-6));
}

TEST_CASE("nor do the quasi-Newton searches by themselves, without Levenberg-Marquardt") {
    for (const Algorithm algorithm : {Algorithm::slsqp, Algorithm::lbfgs})
        for (const double start : {3.0, 5.0}) {
            CAPTURE(to_string(algorithm), start);
            Method alone = with(algorithm);
            alone.levenberg_marquardt = false;
            CHECK(found("alpha", start, alone).value == Approx(1.0).epsilon(1e-6));
        }
}

TEST_CASE(
    "of NLopt's end and that of Levenberg-Marquardt from the start itself the better is taken, and said") {
    const Found both = found("alpha", 3.0, with(Algorithm::mma));
    CHECK_THAT(both.fit.reason, Catch::Matchers::StartsWith("mma: "));
    CHECK_THAT(both.fit.reason, Catch::Matchers::Contains(
                                    "taken instead: the polish from the start itself, which ends lower"));
    Method alone = with(Algorithm::mma);
    alone.levenberg_marquardt = false;
    const Found mma = found("alpha", 3.0, alone);
    CHECK(mma.fit.chi2 > 1.0);
    CHECK(both.fit.evaluations > mma.fit.evaluations + 2);
    CHECK_THAT(found("alpha", 1.5).fit.reason,
               Catch::Matchers::Contains("ends as low")); // rounding says which of the two
}

// Both starts are on the far side of a barrier: chi2 falls towards another minimum, which is found and whose
// chi2 is poor.
TEST_CASE("a start in another valley ends at its floor, is told to try more, and more find the truth") {
    for (const auto& [name, start, truth] : {std::tuple("kappa", 5.0, 0.5), std::tuple("xi", 10.0, 1.0)}) {
        CAPTURE(name);
        const Found one = found(name, start);
        INFO(one.fit.reason);
        // stationary but for the solver's noise, which at chi2 of 1e6 is worth more than 1e-6 standard errors
        CHECK(one.fit.distance < 1e-3);
        CHECK(chi2_at(name, one.value) < 0.9 * chi2_at(name, start));
        CHECK(one.says("try fit.starts = 20"));
        Method many;
        many.starts = 20;
        const Found best = found(name, start, many);
        CHECK(best.value == Approx(truth).epsilon(1e-6));
        CHECK_FALSE(best.says("try fit.starts"));
    }
}

TEST_CASE("a coupling whose start has the wrong sign is found from several starts") {
    Method many;
    many.starts = 20;
    const Found best = found("gamma2", 0.2, many);
    CHECK(best.value == Approx(pair_truth.at("gamma2")).epsilon(1e-6));
    CHECK(std::ranges::any_of(best.fit.starts, [](const StartResult& s) { return s.start[0] < 0.0; }));
}
