// Rival mechanisms in fits of tracks: derivatives, and which of them made the data.

#include "toy_problems.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/fitting/trajectory.hpp"

#include "catch2/catch.hpp"

#include <cmath>
#include <map>

using namespace rodwake;
using namespace rodwake::fitting;

namespace {

using Values = std::map<std::string, double>;

std::vector<Parameter> parameters(const Values& values, const std::vector<std::string>& free = {}) {
    std::vector<Parameter> all;
    for (const auto& [name, value] : values) {
        Parameter p;
        p.name = name;
        p.start = value;
        p.fixed = std::ranges::find(free, name) == free.end();
        all.push_back(p);
    }
    return all;
}

std::vector<double> starts(const std::vector<Parameter>& all) {
    std::vector<double> values;
    for (const Parameter& p : all)
        values.push_back(p.start);
    return values;
}

/// Two rods that pass each other, with noise of `sigma` (0: none), by a mechanism.
Trajectory pair_by(const Values& truth, double sigma, std::uint64_t seed) {
    Trajectory data;
    data.name = "pair";
    for (int i = 0; i <= 16; ++i)
        data.times.push_back(0.5 * i);
    data.states.assign(data.times.size(), {0.0, 2.0, 0.1, 1.0, -2.0, 0.4});
    const std::vector<Parameter> all = parameters(truth);
    data.states = predict({}, data, 0, all, starts(all));
    RandomStream random(seed);
    for (auto& state : data.states)
        for (double& number : state)
            number += sigma * toy::normal(random);
    data.sigma_position = data.sigma_heading = sigma > 0.0 ? sigma : 1.0;
    data.free_start = sigma > 0.0;
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
    const auto rows = static_cast<Eigen::Index>(problem.residuals);
    const std::vector<double> at = starts(all);
    Eigen::VectorXd r(rows);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(all.size()));
    problem.evaluate(at, r, &jacobian);
    for (std::size_t j = 0; j < all.size(); ++j) {
        constexpr double h = 2e-3;
        const auto moved = [&](double shift) {
            std::vector<double> p = at;
            p[j] += shift;
            Eigen::VectorXd out(rows);
            problem.evaluate(p, out, nullptr);
            return out;
        };
        const Eigen::VectorXd slope =
            (8.0 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12.0 * h);
        const auto column = jacobian.col(static_cast<Eigen::Index>(j));
        INFO(all[j].name);
        CHECK(column.cwiseAbs().maxCoeff() > 1e-3);
        // rtol 1e-10 over h, and h^4 times the fifth derivative
        CHECK((column - slope).cwiseAbs().maxCoeff() < 1e-6 * (1.0 + column.cwiseAbs().maxCoeff()));
    }
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
                const Report told = report(problem, found);
                const double error = told.estimates[index].standard_error;
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
