// Trajectories measured in a periodic box are fitted in it, and rows that share noise count for less.

#include "rod_data.hpp"

#include "rodwake/fitting/report.hpp"
#include "rodwake/rods/simulate.hpp"

#include "catch2/catch.hpp"

#include <cmath>

using namespace rodwake;
using namespace rodwake::fitting;

namespace {

constexpr double box = 5.0;

/// Two rods that meet each other's images.
Trajectory in_box() {
    rods::RodProblem problem;
    problem.medium = elastic::Medium{.eta = 1.5, .xi = 1.25};
    problem.couplings = {.kappa = 2.0, .gamma1 = 0.5};
    problem.rods = {{0.0, 1.0, 0.2}, {1.0, -1.0, 1.1}};
    problem.box = box;
    problem.t_end = 3.0;
    for (int k = 0; k <= 6; ++k)
        problem.output_times.push_back(0.5 * k);
    rods::RodOptions options;
    options.ode.method = integrate::Method::adams;
    options.ode.rtol = 1e-11;
    options.ode.atol = 1e-12;
    const auto run = rods::simulate(problem, options);
    Trajectory one;
    one.name = "box";
    one.times = run.solution.times;
    one.states = run.solution.states;
    one.box = box;
    return one;
}

std::vector<Parameter> couplings_and_medium(double factor) {
    std::vector<Parameter> all;
    for (const auto& [name, value] :
         {std::pair{"kappa", 2.0}, {"gamma1", 0.5}, {"eta", 1.5}, {"alpha", 0.8}}) {
        Parameter p;
        p.name = name;
        p.start = factor * value;
        all.push_back(p);
    }
    all[2].fixed = true;
    all[2].start = 1.5;
    all[3].transform = Transform::log;
    all[3].lower = 1e-3;
    all[3].upper = 1e3;
    return all;
}

Fit fit_of(const Trajectory& one) {
    return fit(trajectory_problem(test::tight(integrate::Method::adams), {one}, couplings_and_medium(1.3)),
               {});
}

} // namespace

TEST_CASE("couplings and medium are found again from a trajectory in its box, and only there", "[.long]") {
    Trajectory one = in_box();
    const Fit found = fit_of(one);
    CHECK(found.termination == Termination::converged);
    CHECK(found.values[0] == Approx(2.0).epsilon(1e-6)); // data to 1e-11, field in the box to 1e-10
    CHECK(found.values[1] == Approx(0.5).epsilon(1e-6));
    CHECK(found.values[3] == Approx(0.8).epsilon(1e-6));
    one.box.reset();
    const Fit on_plane = fit_of(one);
    CHECK(std::abs(on_plane.values[0] - 2.0) > 1e-2);
    CHECK(on_plane.chi2 > 1e6 * found.chi2);
}

TEST_CASE("rows that share noise count for less") {
    Trajectory one = in_box();
    const auto problem = [&] {
        return trajectory_problem(test::tight(integrate::Method::adams), {one}, couplings_and_medium(1.3));
    };
    const auto residuals = [&](const Problem& of) {
        Eigen::VectorXd r(static_cast<Eigen::Index>(of.residuals));
        of.evaluate(std::vector{2.5, 0.5, 1.5, 0.8}, r, nullptr);
        return r;
    };
    const Problem all = problem();
    one.independent = 0.25;
    const Problem quarter = problem();
    CHECK(quarter.independent == Approx(0.25));
    CHECK(residuals(quarter).norm() == Approx(0.5 * residuals(all).norm()));
    CHECK(independent_values(quarter) == std::lround(0.25 * static_cast<double>(all.residuals)));
    one.independent = 0.0;
    CHECK_THROWS_WITH(problem(), Catch::Contains("independent = 0"));
    one.independent = 1.0;
    one.box = -1.0;
    CHECK_THROWS_WITH(problem(), Catch::Contains("box = -1"));
}
