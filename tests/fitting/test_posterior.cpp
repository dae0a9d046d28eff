// Posteriors whose mean, covariance and evidence are known in closed form.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/fitting/posterior.hpp"
#include "synthetic_profiles.hpp"

#include <Eigen/Dense>

using namespace rodwake::fitting;
using namespace fitting_test;

namespace {

/// f_over_mu and offset of a wake at fixed eta and xi: linear, with normal errors.
Problem linear_case() {
    const WakeModel model{std::nullopt, 0.0, 0.0};
    const std::vector<Parameter> list = {{.name = "f_over_mu", .start = 2.0},
                                         {.name = "eta", .start = 1.3, .fixed = true},
                                         {.name = "xi", .start = 22.0, .fixed = true},
                                         {.name = "offset", .start = 0.0, .scale = 0.01}};
    rodwake::RandomStream noise(7);
    const Profile line{.name = "Ux", .component = Component::Ux, .along = Axis::x, .at = 1.0};
    return wake_problem(model, {made_up(model, list, {2.2, 1.3, 22.0, 0.01}, line, 100, 38.0, 0.02, &noise)},
                        list);
}

const std::vector<Prior> wide = {{PriorKind::uniform, -10.0, 10.0}, {PriorKind::uniform, -1.0, 1.0}};

struct ClosedForm {
    Eigen::Vector2d mean;
    Eigen::Matrix2d covariance;
    double log_evidence = 0.0;
};

/// Under priors that are flat where the likelihood is.
ClosedForm closed_form(const Problem& problem, double log_prior) {
    const auto n = static_cast<Eigen::Index>(problem.residuals);
    Eigen::VectorXd r(n);
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, 4), j(n, 2);
    const std::vector<double> at = {2.0, 1.3, 22.0, 0.0};
    problem.evaluate(at, r, &all);
    j << all.col(0), all.col(3);
    ClosedForm c;
    c.covariance = (j.transpose() * j).inverse();
    const Eigen::Vector2d change = -c.covariance * (j.transpose() * r);
    c.mean = Eigen::Vector2d(2.0, 0.0) + change;
    const double chi2 = (r + j * change).squaredNorm(), log_2pi = std::log(2.0 * M_PI);
    c.log_evidence = -0.5 * chi2 - static_cast<double>(n) * (std::log(0.02) + 0.5 * log_2pi) + log_2pi +
                     0.5 * std::log(c.covariance.determinant()) + log_prior;
    return c;
}

Posterior sampled(const Problem& problem, const PosteriorMethod& method) {
    return sample(problem, wide, std::vector<double>{2.0, 1.3, 22.0, 0.0}, method).value();
}

} // namespace

TEST_CASE("a linear posterior has the mean, the errors and the evidence of its closed form") {
    const Problem problem = linear_case();
    const ClosedForm truth = closed_form(problem, -std::log(20.0) - std::log(2.0));
    const Posterior found = sampled(problem, {});
    for (const Eigen::Index k : {0, 1}) {
        const Marginal& m = found.marginals[static_cast<std::size_t>(k)];
        const double sd = std::sqrt(truth.covariance(k, k));
        CHECK(m.ess > 1000.0);
        CHECK(m.rhat < 1.01);
        CHECK(std::abs(m.mean - truth.mean[k]) < 4.0 * sd / std::sqrt(m.ess)); // four Monte-Carlo errors
        CHECK(std::abs(m.sd / sd - 1.0) < 4.0 / std::sqrt(2.0 * m.ess));
    }
    CHECK(std::abs(found.log_evidence->value - truth.log_evidence) < 0.05); // what users are told
    CHECK(found.log_evidence->error < 0.0125);                              // a quarter of it
    CHECK(found.remarks.empty());
}

TEST_CASE("samples are the same for any threads and after an interruption") {
    const Problem problem = linear_case();
    PosteriorMethod method{.chains = 2, .samples = 300};
    const Posterior whole = sampled(problem, method);
    method.threads = 2;
    CHECK(sampled(problem, method).values == whole.values);
    std::vector<ChainBlock> done;
    method.on_block_done = [&](const ChainBlock& block) { done.push_back(block); };
    method.stop_requested = [&] { return done.size() > 9; };
    CHECK_FALSE(sample(problem, wide, std::vector<double>{2.0, 1.3, 22.0, 0.0}, method));
    method.stop_requested = nullptr;
    method.done = done;
    const Posterior resumed = sampled(problem, method);
    CHECK(resumed.values == whole.values);
    CHECK(resumed.log_evidence->value == whole.log_evidence->value);
    method = {.chains = 2, .samples = 300, .seed = 2};
    CHECK(sampled(problem, method).values != whole.values);
}

TEST_CASE("chains at different places are told from chains that mix") {
    std::vector<std::vector<double>> chains(4, std::vector<double>(500));
    for (std::size_t c = 0; c < 4; ++c) {
        rodwake::RandomStream random(3, static_cast<std::uint32_t>(c));
        for (double& value : chains[c])
            value = normal(random);
    }
    CHECK(marginal(chains).rhat < 1.01);
    CHECK(marginal(chains).ess > 1500.0); // of 2000 independent ones
    for (double& value : chains[0])
        value += 2.0;
    CHECK(marginal(chains).rhat > 1.1);
    CHECK(marginal(chains).ess < 100.0);
}

TEST_CASE("improper priors are refused") {
    const Problem problem = linear_case();
    for (const Prior& wrong :
         {Prior{PriorKind::uniform, 0.0, {}}, Prior{PriorKind::uniform, 1.0, 0.0},
          Prior{PriorKind::log_uniform, 0.0, 1.0}, Prior{PriorKind::normal, {}, {}, 1.0, 0.0}})
        CHECK_THROWS_AS(sample(problem, {wrong, wide[1]}, std::vector<double>{2.0, 1.3, 22.0, 0.0}, {}),
                        rodwake::InputError);
}
