// Posteriors whose mean, covariance and evidence are known: in closed form, or from a fine grid.

#include "catch2/catch.hpp"
#include "made_up_map.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/fitting/posterior.hpp"
#include "swimming_pair.hpp"
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
    return wake_problem(model, {made_up(model, list, {2.2, 1.3, 22.0, 0.01}, line, 40, 38.0, 0.02, &noise)},
                        list);
}

const std::vector<Prior> wide = {{PriorKind::uniform, -10.0, 10.0}, {PriorKind::uniform, -1.0, 1.0}};
const std::vector<double> linear_start = {2.0, 1.3, 22.0, 0.0};

struct ClosedForm {
    Eigen::Vector2d mean;
    Eigen::Matrix2d covariance;
    double log_evidence = 0.0;
};

/// Under priors that are flat where the likelihood is.
ClosedForm closed_form(const Problem& problem, double log_prior) {
    Eigen::MatrixXd all;
    const Eigen::VectorXd r = ::toy::residuals(problem, linear_start, &all);
    const Eigen::Index n = r.size();
    Eigen::MatrixXd j(n, 2);
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

double covariance(const Posterior& found, std::size_t a, std::size_t b) {
    double sum = 0.0, count = 0.0;
    for (std::size_t c = 0; c < found.values[a].size(); ++c)
        for (std::size_t i = 0; i < found.values[a][c].size(); ++i, ++count)
            sum += (found.values[a][c][i] - found.marginals[a].mean) *
                   (found.values[b][c][i] - found.marginals[b].mean);
    return sum / count;
}

/// Residuals by a function of the free parameters; sigma 1.
template<class Residuals>
Problem toy(std::vector<Parameter> parameters, std::size_t count, Residuals residuals) {
    Problem problem;
    problem.parameters = std::move(parameters);
    problem.residuals = count;
    problem.evaluate = [=](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, Eigen::MatrixXd*) {
        residuals(p, r);
    };
    return problem;
}

/// a exp(-x/l) + b at ten places: three parameters, of which two are bound by few data and by their priors.
Problem decay() {
    return toy({{.name = "a", .start = 2.0}, {.name = "l", .start = 3.0}, {.name = "b", .start = 0.0}}, 10,
               [](auto p, auto r) {
                   for (Eigen::Index i = 0; i < 10; ++i) {
                       const double x = 0.7 * static_cast<double>(i),
                                    datum = 2.0 * std::exp(-x / 3.0) + 0.1 * std::sin(7.0 * x);
                       r[i] = (p[0] * std::exp(-x / p[1]) + p[2] - datum) / 0.15;
                   }
               });
}

const std::vector<Prior> decay_priors = {{PriorKind::uniform, 0.0, 5.0},
                                         {PriorKind::log_uniform, 0.1, 30.0},
                                         {PriorKind::normal, -0.6, 3.0, 0.2, 0.5}};

/// Sums over a grid of the values themselves, by `log_prior` and `log_likelihood`.
struct Grid {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero(), square = Eigen::Vector3d::Zero();
    double evidence = 0.0;

    explicit Grid(const Density& density, int n = 60) {
        for (int i = 0; i < n * n * n; ++i) {
            const auto at = [n](int k, double low, double high) {
                return low + (high - low) * (k + 0.5) / n;
            };
            const double l = std::exp(at(i / n % n, std::log(0.1), std::log(30.0)));
            const Eigen::Vector3d p(at(i % n, 0.0, 5.0), l, at(i / n / n, -0.6, 1.7));
            const std::span<const double> values(p.data(), 3);
            const double cell = 5.0 * l * (std::log(30.0) - std::log(0.1)) * 2.3 / (n * n * n),
                         weight = cell * std::exp(density.log_likelihood(values) + density.log_prior(values));
            evidence += weight, mean += weight * p, square += weight * p.cwiseProduct(p);
        }
        mean /= evidence, square /= evidence;
    }
};

Posterior sampled(const Problem& problem, const PosteriorMethod& method) {
    return sample(problem, wide, linear_start, method).value();
}

bool remarks_on(const Posterior& found, const std::string& words) {
    return std::ranges::any_of(
        found.remarks, [&](const std::string& remark) { return remark.find(words) != std::string::npos; });
}

} // namespace

TEST_CASE("a linear posterior has the mean, the covariance and the evidence of its closed form") {
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
    const double scale = std::sqrt(truth.covariance(0, 0) * truth.covariance(1, 1));
    CHECK(std::abs(covariance(found, 0, 1) - truth.covariance(0, 1)) <
          4.0 * scale * std::sqrt(2.0 / found.marginals[0].ess));
    CHECK(std::abs(found.log_evidence->value - truth.log_evidence) < 0.05); // the error that users read
    CHECK(found.log_evidence->error < 0.0125);                              // a quarter of it
    CHECK(found.remarks.empty());
}

TEST_CASE("three parameters that are not linear, with a prior of each kind, are as a fine grid has them") {
    const Problem problem = decay();
    const Density density(problem, decay_priors);
    const Grid grid(density);
    const Posterior found = sample(problem, decay_priors, std::vector{2.0, 3.0, 0.0}, {}).value();
    for (const Eigen::Index k : {0, 1, 2}) {
        const Marginal& m = found.marginals[static_cast<std::size_t>(k)];
        const double sd = std::sqrt(grid.square[k] - grid.mean[k] * grid.mean[k]);
        CHECK(m.rhat < 1.01);
        CHECK(m.ess > 1000.0);
        CHECK(std::abs(m.mean - grid.mean[k]) < 4.0 * sd / std::sqrt(m.ess)); // four Monte-Carlo errors
        CHECK(std::abs(m.sd / sd - 1.0) < 0.1); // heavy tails: four errors of a tenth of the samples
    }
    CHECK(std::abs(found.log_evidence->value - std::log(grid.evidence)) < 0.05); // four errors
}

TEST_CASE("two places that explain the data are both found, and weighed rightly") {
    // x^2 = 4 +- 0.2 and a weak datum x = 1 +- 3
    const Problem problem = toy({{.name = "x", .start = 1.0}}, 2, [](auto p, auto r) {
        r[0] = (p[0] * p[0] - 4.0) / 0.2, r[1] = (p[0] - 1.0) / 3.0;
    });
    const std::vector<Prior> prior = {{PriorKind::uniform, -10.0, 10.0}};
    const Posterior found = sample(problem, prior, std::vector{1.0}, {}).value();
    const Density density(problem, prior);
    double below = 0.0, all = 0.0;
    for (double x = -4.0005; x < 4.0; x += 0.001) {
        const double one = std::exp(density.log_likelihood({{x}}) + density.log_prior({{x}})) * 0.001;
        below += x < 0.0 ? one : 0.0, all += one;
    }
    double share = 0.0;
    for (const auto& chain : found.values[0])
        share += static_cast<double>(std::ranges::count_if(chain, [](double x) { return x < 0.0; })) / 4000.0;
    CHECK(found.marginals[0].rhat < 1.01);
    CHECK(std::abs(share - below / all) < 0.04); // four errors of 2500 effective samples
    CHECK(std::abs(found.log_evidence->value - std::log(all)) < 0.05);
}

TEST_CASE("without information in the data the samples are those of the priors") {
    const Problem problem =
        toy({{.name = "a", .start = 1.0}, {.name = "b", .start = 1.0}, {.name = "c", .start = 1.0}}, 3,
            [](auto, auto r) { r.setZero(); });
    const std::vector<Prior> priors = {{PriorKind::uniform, 1.0, 3.0},
                                       {PriorKind::log_uniform, 0.1, 10.0},
                                       {PriorKind::normal, 0.0, {}, 0.0, 2.0}}; // a half of the normal
    const Posterior found = sample(problem, priors, std::vector{1.5, 1.0, 1.0}, {}).value();
    const double median[] = {2.0, 1.0, 2.0 * 0.67449}, q975[] = {2.95, std::pow(10.0, 0.95), 2.0 * 2.24140};
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(found.marginals[k].median == Approx(median[k]).epsilon(0.06)); // four errors at most
        CHECK(found.marginals[k].q975 == Approx(q975[k]).epsilon(0.06));
        CHECK(remarks_on(found, "the data hardly constrain " + problem.parameters[k].name));
    }
    CHECK(found.log_evidence->value == Approx(-1.5 * std::log(2.0 * M_PI)).margin(0.05));
}

TEST_CASE("what is not to be trusted is said, with what to do") {
    const PosteriorMethod few{.samples = 800};
    const auto line = [](double datum) {
        return toy({{.name = "a", .start = 0.5}}, 1, [=](auto p, auto r) { r[0] = (p[0] - datum) / 0.02; });
    };
    const std::vector<Prior> unit = {{PriorKind::uniform, 0.0, 1.0}};
    CHECK(remarks_on(sample(line(1.5), unit, std::vector{0.5}, few).value(), "against the upper end"));
    CHECK(remarks_on(sample(line(-0.5), unit, std::vector{0.5}, few).value(), "against the lower end"));
    CHECK(sample(line(0.5), unit, std::vector{0.5}, few).value().remarks.empty());
    CHECK(sample(line(0.1), unit, std::vector{0.5}, few).value().remarks.empty()); // five errors from the end
    const std::vector<Prior> normal = {{PriorKind::normal, {}, {}, 0.0, 0.1}};     // a tail is no end
    CHECK(remarks_on(sample(line(0.5), normal, std::vector{0.5}, few).value(),
                     "in the upper tail of its normal"));
    CHECK(remarks_on(sample(line(-0.5), normal, std::vector{0.5}, few).value(),
                     "in the lower tail of its normal"));
    CHECK(sample(line(0.16), normal, std::vector{0.5}, few).value().remarks.empty());
    const std::vector<Prior> endless = {{PriorKind::uniform, 1e-6, 1e6}};
    CHECK(remarks_on(sample(line(0.5), endless, std::vector{0.5}, few).value(), "in the lowest 5e-07"));
    // a model that exists in one place
    const Problem point = toy({{.name = "a", .start = 0.5}}, 1, [](auto p, auto r) {
        if (p[0] != 0.5)
            throw rodwake::RunError("none");
        r[0] = 0.0;
    });
    CHECK(remarks_on(sample(point, unit, std::vector{0.5}, {.samples = 400}).value(), "stuck"));
}

TEST_CASE("the likelihood has the sigmas of every kind of data") {
    const Problem map = map_problem(made_up_map::model, {made_up_map::map_of(6, 0.03)}, {},
                                    made_up_map::free_ones({"amplitude"})),
                  pair = rodwake::test::pair_problem("kappa", 0.5, 0.05);
    const auto expected = [](std::size_t count, double sigma) {
        return -static_cast<double>(count) * (std::log(sigma) + 0.5 * std::log(2.0 * M_PI));
    };
    const std::vector<Prior> prior = {{PriorKind::uniform, 0.0, 2.0}};
    CHECK(Density(map, prior).log_likelihood({{0.8}}) == Approx(expected(72, 0.03)));
    CHECK(Density(pair, prior).log_likelihood({{0.5}}) == Approx(expected(24 * 6, 0.05)));
    const Problem together = joined({map, pair});
    const Density both(together, {prior[0], prior[0]});
    CHECK(both.log_likelihood({{0.8, 0.5}}) == Approx(expected(72, 0.03) + expected(24 * 6, 0.05)));
    double sum = 0.0;
    for (const double one : both.log_likelihoods({{0.7, 0.4}}))
        sum += one;
    CHECK(sum == Approx(both.log_likelihood({{0.7, 0.4}})));
}

TEST_CASE("the coupling of two rods is as well known as its derivative says") {
    Trajectory data = rodwake::test::swimming_pair();
    data.times.resize(5), data.states.resize(5);
    data.sigma_position = data.sigma_heading = 0.005;
    const Problem pair = trajectory_problem({}, {data}, rodwake::test::pair_parameters("kappa", 0.5));
    const std::vector<double> values = all_values(pair, {{0.5}});
    Eigen::MatrixXd j;
    ::toy::residuals(pair, values, &j);
    const double error = 1.0 / j.col(static_cast<Eigen::Index>(free_parameters(pair).front())).norm();
    const Posterior found =
        sample(pair, {{PriorKind::uniform, 0.0, 2.0}}, values, {.chains = 2, .samples = 200}).value();
    CHECK(std::abs(found.marginals[0].mean - 0.5) < 4.0 * error / std::sqrt(100.0)); // four errors
    CHECK(found.marginals[0].sd == Approx(error).epsilon(0.3));                      // the same
}

TEST_CASE("samples are the same for any threads and after an interruption", "[threads]") {
    const Problem problem = linear_case();
    PosteriorMethod method{.chains = 2, .samples = 300};
    const Posterior whole = sampled(problem, method);
    method.threads = 2;
    CHECK(sampled(problem, method).values == whole.values);
    std::vector<ChainBlock> done;
    method.on_block_done = [&](const ChainBlock& block) { done.push_back(block); };
    method.stop_requested = [&] { return done.size() > 9; };
    CHECK_FALSE(sample(problem, wide, linear_start, method));
    method.stop_requested = nullptr;
    method.done = done;
    const Posterior resumed = sampled(problem, method);
    CHECK(resumed.values == whole.values);
    CHECK(resumed.log_evidence->value == whole.log_evidence->value);
    method = {.chains = 2, .samples = 300, .seed = 2};
    CHECK(sampled(problem, method).values != whole.values);
}

TEST_CASE("chains at different positions are distinguished from chains that mix") {
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

TEST_CASE("data that no parameters reach are reported, and others are sampled, whatever their errors") {
    const std::vector<Prior> priors = {{PriorKind::uniform, 0.0, 5.0}, {PriorKind::uniform, -5.0, 5.0}};
    const auto sampled = [&](double off, double sigma, bool level, bool one, bool holes) {
        const Problem problem =
            toy({{.name = "a", .start = 0.0}, {.name = "b", .start = 0.0}}, one ? 1 : 6, [=](auto p, auto r) {
                for (Eigen::Index i = 0; i < r.size(); ++i)
                    r[i] = (p[0] * (level ? 0.0 : static_cast<double>(i)) + p[1] - 1.0 - off) / sigma;
                if (holes && p[0] > 0.5)
                    r[0] = std::nan("");
            });
        return sample(problem, priors, std::vector<double>{0.0, 0.0}, {.chains = 2, .samples = 80});
    };
    for (const double off : {0.0, 1e7})
        for (const double sigma : {1e-150, 4e-12, 1e-6, 1.0, 1e12})
            for (const int kind : {0, 1, 2, 4, 5}) {
                INFO(off << " off, sigma " << sigma << ", kind " << kind);
                try {
                    const auto found = sampled(off, sigma, kind & 1, kind & 2, kind & 4);
                    CHECK(std::isfinite(found->marginals[1].mean));
                } catch (const rodwake::RunError& error) {
                    CHECK((off / sigma > 1e5 || sigma < 1e-9)); // so narrow a peak may not be found
                    CHECK(std::string(error.what()).find("posterior: ") == 0);
                } catch (const rodwake::InputError&) {
                    CHECK((kind & 2) != 0); // one datum for two parameters
                }
            }
}

TEST_CASE("improper priors are refused") {
    const Problem problem = linear_case();
    for (const Prior& wrong :
         {Prior{PriorKind::uniform, 0.0, {}}, Prior{PriorKind::uniform, 1.0, 0.0},
          Prior{PriorKind::log_uniform, 0.0, 1.0}, Prior{PriorKind::normal, {}, {}, 1.0, 0.0}})
        CHECK_THROWS_AS(sample(problem, {wrong, wide[1]}, linear_start, {}), rodwake::InputError);
    CHECK_THROWS_AS(sample(problem, {wide[1]}, linear_start, {}), rodwake::InputError);
}
