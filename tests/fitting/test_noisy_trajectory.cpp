// Tracks of rods that diffuse: likelihoods in closed form, and truths that come back from made-up noise.

#include "toy_problems.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/fitting/density.hpp"
#include "rodwake/fitting/misfit.hpp"
#include "rodwake/fitting/report.hpp"
#include "rodwake/fitting/trajectory.hpp"
#include "rodwake/rods/noise.hpp"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>

#include <cmath>
#include <map>

using namespace rodwake;
using namespace rodwake::fitting;
using toy::parameters;
using toy::starts;

namespace {

/// Diffusion coefficients are bounded.
std::vector<Parameter> noisy_parameters(const std::map<std::string, double>& values,
                                        const std::vector<std::string>& free) {
    std::vector<Parameter> all = toy::parameters(values, free);
    for (Parameter& p : all)
        if (p.name.starts_with("D_"))
            p.lower = 0.0, p.upper = 10.0;
    return all;
}

constexpr double D_r = 0.02, kappa = 1.0, sigma = 0.02;

/// Two rods that pass each other in each other's wakes and diffuse, seen with errors; `run`: which noise.
Trajectory wandering_pair(std::uint32_t run, double rotational = D_r) {
    rods::RodProblem made;
    made.medium = elastic::Medium{.eta = 1.3, .xi = 1.25};
    made.couplings.kappa = kappa;
    made.rods = {{0.0, 1.5, 0.1}, {1.0, -1.5, 0.4}};
    made.t_end = 8.0;
    Trajectory data;
    data.name = "pair";
    for (int i = 0; i <= 16; ++i)
        data.times.push_back(0.5 * i);
    made.output_times = data.times;
    data.states = rods::simulate(made, {}, {rotational, 0.0, 0.05, 11}, run).solution.states;
    RandomStream random(100 + run);
    for (auto& state : data.states)
        for (double& number : state)
            number += sigma * toy::normal(random);
    data.sigma_position = data.sigma_heading = sigma;
    data.free_start = true;
    return data;
}

const std::map<std::string, double> truth{{"kappa", kappa}, {"eta", 1.3}, {"alpha", 0.8}, {"D_r", D_r}};

/// (found - true)/error of kappa, and ln of the estimate of D_r over the true one.
std::pair<double, double> pull(const Trajectory& data, double held_noise = -1.0) {
    auto values = truth;
    std::vector<std::string> free = {"kappa"};
    if (held_noise < 0.0)
        free.emplace_back("D_r");
    else
        values["D_r"] = held_noise;
    const Problem problem = trajectory_problem({}, {data}, noisy_parameters(values, free));
    const Fit found = fit(problem, {});
    const Report reported = report(problem, found);
    const auto at = [&](const char* name) {
        return *std::ranges::find(reported.estimates, name, &fitting::ParameterEstimate::name);
    };
    return {(at("kappa").value - kappa) / at("kappa").standard_error, std::log(at("D_r").value / D_r)};
}

} // namespace

TEST_CASE("headings that diffuse freely have their likelihood in closed form") {
    Trajectory data;
    data.name = "free";
    RandomStream random(3);
    double heading = 0.0;
    for (int i = 0; i < 12; ++i) {
        data.times.push_back(0.3 * i + 0.01 * i * i);
        heading += 0.2 * toy::normal(random);
        data.states.push_back({0.0, 0.0, heading, 5.0, 0.0, 1.0});
    }
    data.sigma_position = 1e6; // they tell nothing
    data.sigma_heading = 0.1;
    for (const bool measured : {false, true}) {
        data.free_headings = measured;
        const Problem problem = trajectory_problem({}, {data}, noisy_parameters({{"D_r", 0.05}}, {"D_r"}));
        const Density density(problem, {{PriorKind::uniform, 0.0, 1.0}});
        for (const double D : {0.0, 0.01, 0.3}) {
            const Eigen::Index n = 11;
            double expected = -4.0 * static_cast<double>(n) * std::log(1e6 * std::sqrt(2.0 * M_PI));
            for (const double rod : {0.0, 1.0}) {
                Eigen::MatrixXd covariance(n, n);
                Eigen::VectorXd turned(n);
                for (Eigen::Index i = 0; i < n; ++i) {
                    const auto at = static_cast<std::size_t>(i + 1);
                    turned[i] = rod == 0.0 ? data.states[at][2] - data.states[0][2] : 0.0;
                    for (Eigen::Index j = 0; j < n; ++j)
                        covariance(i, j) =
                            2.0 * D * data.times[static_cast<std::size_t>(std::min(i, j) + 1)] +
                            (i == j ? 0.01 : 0.0) + (measured ? 0.01 : 0.0);
                }
                const Eigen::LLT<Eigen::MatrixXd> root(covariance);
                const Eigen::VectorXd white = root.matrixL().solve(turned);
                expected -= 0.5 * white.squaredNorm() + root.matrixLLT().diagonal().array().log().sum() +
                            0.5 * static_cast<double>(n) * std::log(2.0 * M_PI);
            }
            INFO(D << (measured ? ", start measured" : ""));
            // 1e-8 of the solver on variances, and places of 1e6 sigma apart by 3: 1e-11
            CHECK(density.log_likelihood(std::vector{D}) == Approx(expected).epsilon(1e-9).margin(1e-6));
        }
    }
}

TEST_CASE("without noise of their own the rods follow the trajectory, and residuals are the same") {
    Trajectory data = wandering_pair(1);
    data.free_start = false;
    auto values = truth;
    values["D_r"] = 0.0;
    const Problem noisy = trajectory_problem({}, {data}, noisy_parameters(values, {"kappa"}));
    values.erase("D_r");
    const Problem plain = trajectory_problem({}, {data}, noisy_parameters(values, {"kappa"}));
    const auto at = [](const Problem& problem) {
        Eigen::MatrixXd slopes;
        const Eigen::VectorXd r = toy::residuals(problem, toy::starts(problem.parameters), &slopes);
        const auto kappa_at =
            std::ranges::find(problem.parameters, "kappa", &Parameter::name) - problem.parameters.begin();
        return std::pair(r, Eigen::VectorXd(slopes.col(kappa_at)));
    };
    const auto [r, slope] = at(noisy);
    const auto [plain_r, plain_slope] = at(plain);
    REQUIRE(r.size() == 2 * plain_r.size());
    // places of up to 10 with rtol 1e-8 over sigma; slopes besides over the step of 2e-3
    CHECK((r.head(plain_r.size()) - plain_r).cwiseAbs().maxCoeff() < 1e-4);
    CHECK((slope.head(plain_r.size()) - plain_slope).cwiseAbs().maxCoeff() < 1e-2);
    CHECK((r.tail(plain_r.size()).array() - 1.0).abs().maxCoeff() < 1e-12);
    CHECK(noisy.residual_name(5) == plain.residual_name(5));
}

TEST_CASE("couplings and diffusion come back from rods that wander") {
    double sum = 0.0, squares = 0.0, noise = 0.0, wrong = 0.0;
    constexpr int sets = 3;
    for (int set = 0; set < sets; ++set) {
        const Trajectory data = wandering_pair(static_cast<std::uint32_t>(set));
        const auto [apart, ratio] = pull(data);
        sum += apart, squares += apart * apart, noise += ratio;
        wrong += std::pow(pull(data, 0.0).first, 2);
    }
    CHECK(std::abs(sum) < 3.0 * std::sqrt(sets));
    CHECK(squares < 12.8);               // chi2 of 3: 0.995
    CHECK(std::abs(noise / sets) < 0.4); // 32 turns of rods, 0.25 and more a set
    CHECK(wrong > 5.0 * squares);        // noise that is taken for the measurement's makes errors too small
}

TEST_CASE("rods whose noise is left out are not described") {
    const Trajectory data = wandering_pair(4);
    const auto speaks = [&](double held) {
        auto values = truth;
        values["D_r"] = held;
        const Problem problem = trajectory_problem({}, {data}, noisy_parameters(values, {"kappa"}));
        const Fit found = fit(problem, {});
        CHECK(found.objective > found.chi2 + 95.0); // 96 scales, each 1 or more
        return misfit(problem, found, 1).probability.value();
    };
    CHECK(speaks(0.0) < 1e-3);
    CHECK(speaks(D_r) > 0.05);
}

TEST_CASE("what a filter cannot use is refused") {
    const auto refuses = [](auto change, const char* text) {
        Trajectory data = wandering_pair(1);
        change(data);
        CHECK_THROWS_WITH(trajectory_problem({}, {data}, noisy_parameters(truth, {"kappa", "D_r"})),
                          Catch::Matchers::Contains(text));
    };
    refuses([](Trajectory& t) { t.independent = 0.5; }, "independent_time");
    refuses([](Trajectory& t) { t.contact_distance = 0.1, t.contact_time = 5.0; }, "contact_time");
    refuses([](Trajectory& t) { t.times.resize(1), t.states.resize(1); }, "a single row");
    const Problem problem =
        trajectory_problem({}, {wandering_pair(1)}, noisy_parameters(truth, {"kappa", "D_r"}));
    const Density density(problem, {{PriorKind::uniform, -1.0, 1.0}, {PriorKind::uniform, 0.0, 1.0}});
    CHECK(std::isinf(density.log_likelihood(std::vector{-0.01, 1.0})));
}

// --- Rival mechanisms in fits of tracks: derivatives, and which of them made the data

namespace {

using Values = std::map<std::string, double>;

/// Two rods that pass each other, with noise of `noise` (0: none), by a mechanism.
Trajectory pair_by(const Values& made_with, double noise, std::uint64_t seed) {
    Trajectory data;
    data.name = "pair";
    for (int i = 0; i <= 16; ++i)
        data.times.push_back(0.5 * i);
    data.states.assign(data.times.size(), {0.0, 2.0, 0.1, 1.0, -2.0, 0.4});
    const std::vector<Parameter> all = parameters(made_with);
    data.states = predict({}, data, 0, all, starts(all));
    RandomStream random(seed);
    for (auto& state : data.states)
        for (double& number : state)
            number += noise * toy::normal(random);
    data.sigma_position = data.sigma_heading = noise > 0.0 ? noise : 1.0;
    data.free_start = noise > 0.0;
    return data;
}

const Values medium{{"eta", 1.3}, {"alpha", 0.8}};

Values with(Values values, const Values& more) {
    values.insert(more.begin(), more.end());
    return values;
}

} // namespace

TEST_CASE("tracks have the derivatives by the flow, the rows and the medium that the flow brings in") {
    const Values values =
        with(medium, {{"kappa", 0.3}, {"gamma_flow", 0.7}, {"gamma_rows", 0.2}, {"rows_direction", 0.1}});
    const std::vector<Parameter> all =
        parameters(values, {"eta", "alpha", "kappa", "gamma_flow", "gamma_rows", "rows_direction"});
    const Problem problem = trajectory_problem({}, {pair_by(medium, 0.0, 1)}, all);
    Eigen::MatrixXd jacobian;
    toy::residuals(problem, starts(all), &jacobian);
    for (std::size_t j = 0; j < all.size(); ++j) {
        INFO(all[j].name);
        CHECK(jacobian.col(static_cast<Eigen::Index>(j)).cwiseAbs().maxCoeff() > 1e-3);
    }
    CHECK(toy::jacobian_error(problem, starts(all)) < 1e-5); // rtol 1e-10 over steps of 3e-4 and more
}

TEST_CASE("the mechanism that made a track fits it, and comes back") {
    const std::map<std::string, Values> mechanisms = {
        {"strain", {{"kappa", 0.5}}},
        {"flow", {{"gamma_flow", 1.0}}},
        {"rows", {{"gamma_rows", 0.1}, {"rows_direction", 0.0}}},
        {"none", {}}};
    for (const auto& [made, strength] : mechanisms) {
        const Trajectory data = pair_by(with(medium, strength), 0.01, 5);
        std::map<std::string, double> criterion;
        for (const auto& [tried, terms] : mechanisms) {
            std::vector<std::string> free;
            for (const auto& [name, value] : terms)
                if (name != "rows_direction")
                    free.push_back(name);
            const Problem problem = trajectory_problem({}, {data}, parameters(with(medium, terms), free));
            const Fit found = fit(problem, {});
            criterion[tried] = found.chi2 + 2.0 * static_cast<double>(free.size());
            if (tried == made && !free.empty()) {
                const auto index = static_cast<std::size_t>(
                    std::ranges::find(problem.parameters, free.front(), &Parameter::name) -
                    problem.parameters.begin());
                const Report reported = report(problem, found);
                const double error = reported.estimates[index].standard_error;
                CHECK(std::abs(found.values[index] - strength.at(free.front())) < 4.0 * error);
            }
        }
        INFO(made);
        for (const auto& [tried, aic] : criterion)
            if (tried != made)
                CHECK(criterion.at(made) < aic + 4.0); // a useless parameter wins 4 by chance in 1 of 40
    }
}

TEST_CASE("what turns rods must have what it needs") {
    const auto refuses = [](const Values& values, const std::vector<std::string>& free, const char* text) {
        CHECK_THROWS_WITH(trajectory_problem({}, {pair_by(medium, 0.0, 1)}, parameters(values, free)),
                          Catch::Matchers::Contains(text));
    };
    refuses({{"gamma_flow", 1.0}}, {"gamma_flow"}, "eta is missing");
    refuses({{"eta", 1.0}, {"gamma_flow", 1.0}}, {"gamma_flow"}, "xi (or alpha) is missing");
    refuses({{"rows_direction", 1.0}}, {"rows_direction"}, "rows_direction needs gamma_rows");
    refuses(medium, {"eta"}, "nothing turns");
}
