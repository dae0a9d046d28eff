// Trajectories in a tabulated field against those in the exact one.

#include "rodwake/core/error.hpp"
#include "rodwake/elastic/periodic_table.hpp"
#include "rodwake/elastic/plane_table.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;

namespace {

double worst(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = a.size() == b.size() ? 0.0 : HUGE_VAL;
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

rods::RodProblem crossing(double start) {
    rods::RodProblem problem;
    problem.medium = elastic::Medium{.eta = 1.3, .xi = 2.0};
    problem.couplings = {.kappa = 1.5, .gamma1 = 0.3, .gamma2 = -0.2};
    problem.rods = {{0.0, 2.0, 0.0}, {start, -2.0, 0.5}};
    problem.t_end = 8.0;
    return problem;
}

} // namespace

TEST_CASE("trajectories in a table of tolerance T agree with the exact ones to 100 T") {
    for (const double tolerance : {1e-3, 1e-5}) {
        const auto table =
            std::make_shared<const elastic::PlaneTable>(elastic::make_plane_table(1.3, tolerance, 2));
        for (const double start : {-1.0, 0.5, 3.0})
            for (const auto method : {integrate::Method::erk, integrate::Method::bdf}) {
                rods::RodProblem problem = crossing(start);
                rods::RodOptions options;
                options.ode.method = method;
                options.ode.rtol = 0.1 * tolerance;
                const auto exact = rods::simulate(problem, options);
                problem.field = elastic::table_field(table, *problem.medium);
                const auto from_table = rods::simulate(problem, options);
                REQUIRE(from_table.solution.status.ok());
                const double off = worst(exact.solution.final_state, from_table.solution.final_state);
                CAPTURE(tolerance, start, off);
                CHECK(off <= 100.0 * tolerance);
                CHECK(off > 0.0); // it did come from the table
            }
    }
}

TEST_CASE("in a periodic box too, Jacobian and sensitivities of the table included") {
    rods::RodProblem problem = crossing(0.5);
    problem.box = 9.0;
    const auto exact = rods::model_of(problem);
    rods::RodOptions options;
    options.ode.rtol = 1e-8;
    const auto truth = rods::simulate(problem, options);
    problem.field = elastic::table_field(elastic::PeriodicTable(*problem.medium, 9.0, 1e-8, 2));
    const auto from_table = rods::simulate(problem, options);
    CHECK(worst(truth.solution.final_state, from_table.solution.final_state) < 1e-6); // 100 T
    const auto y = rods::to_state(problem.rods);
    std::vector<double> a(6), b(6);
    exact.rhs(y, a);
    rods::model_of(problem).rhs(y, b);
    CHECK(worst(a, b) < 1e-7); // couplings of order 1, strain and second derivatives of order 0.1
    CHECK(worst(a, b) > 0.0);
    Eigen::MatrixXd by_exact(6, 6), by_table(6, 6);
    exact.jacobian(y, by_exact);
    rods::model_of(problem).jacobian(y, by_table);
    CHECK((by_exact - by_table).cwiseAbs().maxCoeff() < 1e-5); // derivatives by heading 1e-6 of the largest
}

TEST_CASE("a field of another medium or domain is refused") {
    rods::RodProblem problem = crossing(1.0);
    problem.field = elastic::exact_field({.eta = 1.3, .xi = 2.5});
    CHECK_THROWS_AS(rods::simulate(problem, {}), InputError);
    problem.field = elastic::exact_field(*problem.medium, 30.0);
    CHECK_THROWS_AS(rods::simulate(problem, {}), InputError);
    problem.box = 30.0;
    CHECK_NOTHROW(rods::wakes_of(problem));
}
