// Sensitivities of rod trajectories against differences of tight solves by another method.

#include "reference.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/rods/sensitivity.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace rodwake;
using namespace rodwake::rods;
using Catch::Matchers::Contains;
using test::ReferenceCase;

namespace {

constexpr Parameter all_parameters[] = {Parameter::kappa, Parameter::gamma1, Parameter::gamma2,
                                        Parameter::eta, Parameter::xi};

integrate::OdeOptions options_of(const ReferenceCase& one) {
    integrate::OdeOptions options;
    options.method = one.problem.couplings.kappa > 1e3 ? integrate::Method::bdf : integrate::Method::adams;
    options.rtol = 1e-11;
    options.atol = 1e-12;
    return options;
}

/// States at all output times and, after them, the final one and its time.
Eigen::VectorXd outcome(const RodProblem& problem, integrate::Method method) {
    RodOptions options;
    options.ode.method = method;
    options.ode.rtol = 1e-13;
    options.ode.atol = 1e-14;
    const integrate::Solution run = simulate(problem, options).solution;
    std::vector<double> all;
    for (const auto& state : run.states)
        all.insert(all.end(), state.begin(), state.end());
    all.insert(all.end(), run.final_state.begin(), run.final_state.end());
    all.push_back(run.final_time);
    return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

template<class Change>
Eigen::VectorXd by_differences(const RodProblem& problem, integrate::Method method, double step,
                               Change change) {
    Eigen::VectorXd sum = 0.0 * outcome(problem, method);
    constexpr double weights[] = {0.8, -0.2, 4.0 / 105.0, -1.0 / 280.0}; // of order 8
    for (int k = 1; k <= 4; ++k)
        for (const int sign : {1, -1}) {
            RodProblem moved = problem;
            change(moved) += sign * k * step;
            sum += sign * weights[k - 1] / step * outcome(moved, method);
        }
    return sum;
}

/// The same numbers from the sensitivities: the final state moves with the event.
Eigen::MatrixXd stacked(const integrate::SensitivitySolution& run, const integrate::OdeProblem& ode) {
    const Eigen::Index n = run.final_sensitivity.rows(), p = run.final_sensitivity.cols(),
                       times = static_cast<Eigen::Index>(run.sensitivities.size());
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero((times + 1) * n + 1, p);
    for (Eigen::Index k = 0; k < times; ++k)
        all.middleRows(k * n, n) = run.sensitivities[static_cast<std::size_t>(k)];
    all.middleRows(times * n, n) = run.final_sensitivity;
    if (run.event_time_by_parameter.size() > 0) {
        Eigen::VectorXd slope(n);
        ode.rhs(run.solution.final_time, run.solution.final_state,
                {slope.data(), static_cast<std::size_t>(n)});
        all.middleRows(times * n, n) += slope * run.event_time_by_parameter.transpose();
        all.bottomRows(1) = run.event_time_by_parameter.transpose();
    }
    return all;
}

std::vector<double> times_of(const RodProblem& problem) {
    std::vector<double> times = problem.output_times;
    if (times.empty() || times.back() < problem.t_end)
        times.push_back(problem.t_end);
    return times;
}

/// Of the scale on which a parameter matters: gammas beside a large kappa matter little.
double step_of(const RodProblem& problem, Parameter p) {
    const bool polar = p == Parameter::gamma1 || p == Parameter::gamma2;
    return 6e-3 * std::max({0.1, std::abs(value(problem, p)), polar ? 0.02 * problem.couplings.kappa : 0.0});
}

/// Largest error of a column over the column's size.
double relative(const Eigen::VectorXd& got, const Eigen::VectorXd& truth) {
    return (got - truth).cwiseAbs().maxCoeff() / std::max(1e-3, truth.cwiseAbs().maxCoeff());
}

} // namespace

TEST_CASE("sensitivities of the reference trajectories, contacts included, agree with differences") {
    for (ReferenceCase one : test::reference_cases()) {
        if (one.problem.contact_distance)
            one.problem.t_end *= 2.0; // runs from moved parameters meet later
        const std::vector<std::size_t> headings{0, one.problem.rods.size() - 1};
        const auto problem = to_sensitivity_problem(one.problem, all_parameters, headings);
        const auto run = integrate::solve_with_sensitivities(problem, options_of(one), times_of(one.problem));
        INFO(one.name << ": " << run.solution.status.message());
        REQUIRE(run.solution.status.ok());
        CHECK((run.event_time_by_parameter.size() > 0) == one.problem.contact_distance.has_value());
        const Eigen::MatrixXd got = stacked(run, problem.ode);
        const auto method =
            one.problem.couplings.kappa > 1e3 ? integrate::Method::bdf : integrate::Method::erk;
        for (Eigen::Index j = 0; j < got.cols(); ++j) {
            const bool heading = j >= 5;
            const auto change = [&](RodProblem& moved) -> double& {
                return heading ? moved.rods[headings[static_cast<std::size_t>(j - 5)]].heading
                               : value(moved, all_parameters[j]);
            };
            const double step = heading ? 1e-3 : step_of(one.problem, all_parameters[j]);
            const double error = relative(got.col(j), by_differences(one.problem, method, step, change));
            CAPTURE(j);
            // rounding of the differences: a field good to 1e-14 and solves to 1e-12 over steps of 6e-4 and
            // more, in trajectories that part; over steps a third as long it reaches 2e-7
            CHECK(error < 1e-7);
        }
    }
}

TEST_CASE("a coupling that is zero is differentiated too, with nothing else interacting") {
    RodProblem problem;
    problem.medium = elastic::Medium{1.0, 1.0};
    problem.rods = {{0.0, 1.0, 0.0}, {0.5, -1.0, 0.1}};
    problem.t_end = 5.0;
    const auto sensitive = to_sensitivity_problem(problem, all_parameters, {});
    integrate::OdeOptions options;
    options.rtol = 1e-11;
    options.atol = 1e-12;
    const auto run = integrate::solve_with_sensitivities(sensitive, options, std::vector{5.0});
    REQUIRE(run.solution.status.ok());
    const Eigen::MatrixXd got = stacked(run, sensitive.ode);
    for (Eigen::Index j = 0; j < 3; ++j) {
        const auto change = [&](RodProblem& moved) -> double& { return value(moved, all_parameters[j]); };
        const Eigen::VectorXd truth = by_differences(problem, integrate::Method::erk, 1e-3, change);
        CHECK(truth.tail(7).head(6).cwiseAbs().maxCoeff() > 1e-2); // it does matter
        // not the first step sizes: at exactly 0 simulate() takes no field and other steps
        CHECK(relative(got.col(j).tail(7), truth.tail(7)) < 1e-7);
    }
    CHECK(run.final_sensitivity.rightCols(2).isZero(0.0)); // a medium nobody is coupled to
}

TEST_CASE("contacts of bodies are differentiated by their numbers, the couplings and the starts") {
    RodProblem problem; // they cross, turn each other and slide along
    problem.medium = elastic::Medium{1.0, 1.0};
    problem.couplings.kappa = 2.0;
    problem.rods = {{0.0, 0.0, 0.2}, {1.2, -1.0, 1.7}};
    problem.bodies = {{BodyShape{}}, 0.1, 0.7};
    problem.t_end = 1.5;
    constexpr Parameter of_contacts[] = {Parameter::stall_overlap, Parameter::mobility_ratio,
                                         Parameter::kappa};
    const auto sensitive = to_sensitivity_problem(problem, of_contacts, std::vector<std::size_t>{1});
    integrate::OdeOptions options;
    options.method = integrate::Method::bdf;
    options.rtol = 1e-10;
    options.atol = 1e-12;
    const auto run = integrate::solve_with_sensitivities(sensitive, options, std::vector{problem.t_end});
    REQUIRE(run.solution.status.ok());
    const Eigen::MatrixXd got = stacked(run, sensitive.ode);
    for (Eigen::Index j = 0; j < got.cols(); ++j) {
        const auto change = [&](RodProblem& moved) -> double& {
            return j < 3 ? value(moved, of_contacts[j]) : moved.rods[1].heading;
        };
        // second derivatives jump at the touch: steps are small
        const Eigen::VectorXd truth = by_differences(problem, integrate::Method::erk, 1e-5, change);
        CAPTURE(j);
        CHECK(truth.head(6).cwiseAbs().maxCoeff() > 1e-2);
        CHECK(relative(got.col(j), truth) < 1e-5);
    }
}

TEST_CASE("sensitivities in a periodic box match differences, through a contact across the boundary too") {
    RodProblem free;
    free.medium = elastic::Medium{1.5, 0.8};
    free.couplings = {.kappa = 3.0, .gamma1 = 0.4, .gamma2 = -0.3};
    free.rods = {{0.0, 1.0, 0.3}, {1.5, -1.2, 1.4}};
    free.t_end = 1.0;
    free.box = 6.0;
    RodProblem meeting = free; // at the images across the side
    meeting.rods = {{2.0, 0.2, 0.1}, {-2.5, 0.0, 3.0}};
    meeting.contact_distance = 0.2;
    integrate::OdeOptions options;
    options.rtol = 1e-11;
    options.atol = 1e-12;
    for (const RodProblem& problem : {free, meeting}) {
        const auto sensitive = to_sensitivity_problem(problem, all_parameters, std::vector<std::size_t>{1});
        const auto run = integrate::solve_with_sensitivities(sensitive, options, std::vector{problem.t_end});
        REQUIRE(run.solution.status.ok());
        CHECK((run.event_time_by_parameter.size() > 0) == problem.contact_distance.has_value());
        const Eigen::MatrixXd got = stacked(run, sensitive.ode);
        for (Eigen::Index j = 0; j < got.cols(); ++j) {
            const auto change = [&](RodProblem& moved) -> double& {
                return j == 5 ? moved.rods[1].heading : value(moved, all_parameters[j]);
            };
            CAPTURE(j);
            // the differences': solves to 1e-12 in a field good to 1e-10 of the largest at that distance
            CHECK(relative(got.col(j), by_differences(problem, integrate::Method::erk, 2e-3, change)) < 1e-6);
        }
    }
}

TEST_CASE("the comparison with differences notices a sensitivity that is a little wrong") {
    const ReferenceCase one = test::reference_cases()[7];
    auto problem = to_sensitivity_problem(one.problem, all_parameters, {});
    const auto right = problem.by_parameter;
    problem.by_parameter = [right](double t, integrate::State y, Eigen::Ref<Eigen::MatrixXd> by) {
        right(t, y, by);
        by *= 1.0 + 1e-6;
    };
    const auto run = integrate::solve_with_sensitivities(problem, options_of(one), times_of(one.problem));
    const auto change = [&](RodProblem& moved) -> double& { return moved.couplings.kappa; };
    CHECK(relative(stacked(run, problem.ode).col(0),
                   by_differences(one.problem, integrate::Method::erk, 2e-3, change)) > 5e-7);
}

TEST_CASE("sensitivities of what is not there are refused") {
    RodProblem problem = test::reference_cases().front().problem;
    CHECK_THROWS_WITH(to_sensitivity_problem(problem, {}, std::vector<std::size_t>{2}),
                      Contains("rods[2]") && Contains("2 rods"));
    problem.field = elastic::exact_field({2.5, 1.0});
    CHECK_THROWS_WITH(to_sensitivity_problem(problem, all_parameters, {}), Contains("another medium"));
    problem.field.reset();
    problem.medium.reset();
    CHECK_THROWS_AS(to_sensitivity_problem(problem, all_parameters, {}), InputError);
    CHECK_THROWS_AS(value(problem, Parameter::xi), InputError);
    CHECK_NOTHROW(to_sensitivity_problem(problem, {}, std::vector<std::size_t>{1}));
}
