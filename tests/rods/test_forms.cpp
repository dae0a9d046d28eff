// The three forms of the equations have the same solutions; what is particular to each.

#include "reference.hpp"

#include "rods/pose_track.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::rods;
using integrate::Method;

namespace {

struct Way {
    Formulation form;
    Method method;
};
constexpr Way ways[] = {{Formulation::angle, Method::bdf},
                        {Formulation::director, Method::bdf},
                        {Formulation::director, Method::erk},
                        {Formulation::dae, Method::bdf}};

RodOptions options_of(Way way, double rtol) {
    RodOptions options;
    options.form = way.form;
    options.ode.method = way.method;
    options.ode.rtol = rtol;
    options.ode.atol = 0.01 * rtol;
    return options;
}

RodProblem pair_of(Couplings couplings) {
    RodProblem problem;
    problem.medium = elastic::Medium{1.0, 1.0};
    problem.couplings = couplings;
    problem.rods = {{0.0, 1.0, 0.1}, {0.5, -1.0, 0.4}};
    problem.t_end = 10.0;
    return problem;
}

double difference(const RodResult& a, const RodResult& b) {
    double most = 0.0;
    for (std::size_t i = 0; i < a.solution.final_state.size(); ++i)
        most = std::max(most, std::abs(a.solution.final_state[i] - b.solution.final_state[i]));
    return most;
}

} // namespace

TEST_CASE("every form follows the reference trajectories") {
    constexpr double rtol = 1e-8;
    for (const auto& one : test::reference_cases())
        for (const Way way : ways) {
            CAPTURE(one.name, to_string(way.form), integrate::to_string(way.method));
            const RodResult result = simulate(one.problem, options_of(way, rtol));
            REQUIRE(result.solution.status.ok());
            CHECK(test::worst_error(one, result) < 100.0 * rtol); // as for the angle: 83 rtol
            CHECK((result.solution.statistics.drift > 0.0) == (way.form != Formulation::angle));
            CHECK(result.solution.statistics.drift < 100.0 * rtol);
        }
}

TEST_CASE("the director's Jacobian matches differences") {
    const RodProblem problem = pair_of({.kappa = 2.0, .gamma1 = 0.7, .gamma2 = -0.4});
    const auto ode = to_ode(problem, Formulation::director);
    std::vector<double> y = ode.initial_state, up(8), down(8);
    y[2] *= 1.001; // off the unit circle too
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(8, 8);
    ode.jacobian(0.0, y, jacobian);
    for (Eigen::Index j = 0; j < 8; ++j) {
        constexpr double step = 1e-5;
        const auto at = static_cast<std::size_t>(j);
        const double kept = y[at];
        y[at] = kept + step;
        ode.rhs(0.0, y, up);
        y[at] = kept - step;
        ode.rhs(0.0, y, down);
        y[at] = kept;
        for (Eigen::Index i = 0; i < 8; ++i) {
            const auto row = static_cast<std::size_t>(i);
            // step^2 times third derivatives of order 1, and roundings over the step
            CHECK(jacobian(i, j) == Approx((up[row] - down[row]) / (2.0 * step)).margin(1e-8));
        }
    }
}

TEST_CASE("the multiplier holds what would stretch the director") {
    const RodProblem problem = pair_of({.kappa = 2.0, .gamma1 = 0.7, .gamma2 = -0.4});
    const auto dae = to_ode(problem, Formulation::dae);
    const auto director = to_ode(problem, Formulation::director);
    std::vector<double> f(10), expected(8);
    CHECK(std::abs(dae.initial_state[4]) > 1e-3); // -n.h
    dae.rhs(0.0, dae.initial_state, f);
    director.rhs(0.0, director.initial_state, expected);
    for (std::size_t rod = 0; rod < 2; ++rod) {
        for (std::size_t i = 0; i < 4; ++i)
            CHECK(f[5 * rod + i] == Approx(expected[4 * rod + i]).margin(1e-14)); // roundings
        CHECK(std::abs(f[5 * rod + 4]) < 1e-14);
    }
}

TEST_CASE("headings keep their whole turns in every form") {
    RodProblem problem = pair_of({.kappa = 0.5});
    problem.rods[0].heading += 100.0; // some sixteen turns
    const RodResult angle = simulate(problem, options_of({Formulation::angle, Method::erk}, 1e-9));
    REQUIRE(angle.solution.status.ok());
    for (const Way way : {ways[1], ways[2], ways[3]}) {
        const RodResult result = simulate(problem, options_of(way, 1e-9));
        REQUIRE(result.solution.states.size() == angle.solution.states.size());
        CHECK(difference(result, angle) < 1e-6); // 100 rtol, some ten times more from where the rods part
        CHECK(result.outcome.ending == angle.outcome.ending);
        CHECK(result.outcome.turn[0] == Approx(angle.outcome.turn[0]).margin(1e-6));
    }
}

TEST_CASE("turns between two outputs are counted step by step") {
    const std::vector<double> times{0.5, 19.5, 20.0};
    PoseTrack track(Formulation::director, {0.0}, times);
    const auto director = [](double t) { return std::vector{0.0, 0.0, std::cos(t), std::sin(t)}; };
    std::vector<std::vector<double>> raw;
    for (const double t : times)
        raw.push_back(director(t));
    for (int k = 0; k < 20; ++k) {
        const auto before = director(k), after = director(k + 1.0);
        const integrate::Step step = track.step({static_cast<double>(k), k + 1.0, before, after});
        CHECK(step.state_before[2] == Approx(k).margin(1e-12)); // roundings of atan2
        CHECK(step.state[2] == Approx(k + 1.0));
    }
    const auto outputs = track.outputs(raw);
    for (std::size_t k = 0; k < times.size(); ++k)
        CHECK(outputs[k][2] == Approx(times[k]));
    CHECK(track.headings()[0] == Approx(20.0));
}

TEST_CASE("checkpoints of a run, in any form, lead to the same end, to the bit") {
    RodProblem problem = pair_of({.kappa = 5.0});
    problem.rods.push_back({-6.0, -2.0, 0.1});
    for (int k = 0; k <= 20; ++k)
        problem.output_times.push_back(0.5 * k);
    std::vector<Way> all(std::begin(ways), std::end(ways));
    all.insert(all.end(), {{Formulation::angle, Method::adams}, {Formulation::angle, Method::erk}});
    for (const Way way : all) {
        CAPTURE(to_string(way.form), integrate::to_string(way.method));
        RodOptions options = options_of(way, 1e-8);
        // Far below the default: several segments even in a short run. IDAS begins each with short steps.
        options.ode.segment_steps = way.form == Formulation::dae ? 400 : way.method == Method::erk ? 6 : 30;
        RodOptions rest = options;
        std::vector<RodCheckpoint> saved;
        options.on_checkpoint = [&](const RodCheckpoint& at) { saved.push_back(at); };
        const RodResult whole = simulate(problem, options);
        REQUIRE(whole.solution.status.ok());
        REQUIRE(!saved.empty());
        const auto is_whole = [&](const RodResult& run) {
            return run.solution.times == whole.solution.times &&
                   run.solution.states == whole.solution.states &&
                   run.solution.final_state == whole.solution.final_state &&
                   run.solution.statistics.drift == whole.solution.statistics.drift &&
                   run.solution.statistics.steps == whole.solution.statistics.steps &&
                   run.outcome.turn == whole.outcome.turn && run.outcome.ending == whole.outcome.ending &&
                   run.outcome.time == whole.outcome.time &&
                   run.outcome.min_separation == whole.outcome.min_separation;
        };
        // the first, the last and one between
        for (const std::size_t k : {std::size_t(0), saved.size() / 2, saved.size() - 1}) {
            rest.resume_from = saved[k];
            CHECK(is_whole(simulate(problem, rest)));
        }
        rest.resume_from->state[3] += 1e-9; // the comparison can fail
        CHECK_FALSE(is_whole(simulate(problem, rest)));
    }
}

TEST_CASE("a run in any form goes on to a later end") {
    RodProblem problem = pair_of({.kappa = 5.0});
    problem.rods.push_back({-6.0, -2.0, 0.1});
    problem.output_times = {1.0, 2.0, 4.0, 8.0};
    problem.t_end = 8.0;
    for (const Way way : ways) {
        CAPTURE(to_string(way.form), integrate::to_string(way.method));
        RodOptions options = options_of(way, 1e-10);
        RodProblem early = problem;
        early.output_times = {1.0, 2.0, 3.0};
        early.t_end = 4.0;
        std::optional<RodCheckpoint> end;
        RodOptions keeping = options;
        keeping.on_end = [&](const RodCheckpoint& at) { end = at; };
        simulate(early, keeping);
        REQUIRE(end);
        CHECK(end->times == std::vector{1.0, 2.0, 3.0, 4.0});
        const RodResult whole = simulate(problem, options);
        options.resume_from = carried_over(*end, problem, options.criteria);
        REQUIRE(options.resume_from);
        const RodResult run = simulate(problem, options);
        CHECK(run.solution.times == problem.output_times);
        CHECK(difference(run, whole) < 1e-7); // 1000 rtol
        CHECK(run.outcome.ending == whole.outcome.ending);
        CHECK(run.outcome.min_separation == Approx(whole.outcome.min_separation).epsilon(1e-7));

        // No row at 0.5; t = 4 lies in the last fifth of a run to 4.9; a shorter run.
        RodProblem other = problem;
        other.output_times = {0.5};
        CHECK_FALSE(carried_over(*end, other, options.criteria));
        other.output_times = {};
        CHECK(carried_over(*end, other, options.criteria));
        other.t_end = 4.9;
        CHECK_FALSE(carried_over(*end, other, options.criteria));
        other.t_end = 3.0;
        CHECK_FALSE(carried_over(*end, other, options.criteria));
    }
}

TEST_CASE("forms in a periodic box agree") {
    RodProblem problem = pair_of({.kappa = 2.0});
    problem.box = 6.0;
    problem.t_end = 2.0;
    const RodResult angle = simulate(problem, options_of({Formulation::angle, Method::erk}, 1e-7));
    for (const Way way : {ways[1], ways[3]})
        CHECK(difference(simulate(problem, options_of(way, 1e-7)), angle) < 1e-5); // 100 rtol
}

TEST_CASE("dae starts whatever the length of the run and the stiffness") {
    for (const double t_end : {1e-9, 1.0, 1e9}) {
        RodProblem problem = pair_of({.kappa = -0.5});
        problem.rods = {{0.0, 2.5, 0.0}, {0.0, -2.5, 0.0}};
        problem.t_end = t_end;
        CAPTURE(t_end);
        CHECK(simulate(problem, options_of({Formulation::dae, Method::bdf}, 1e-8)).solution.status.ok());
    }
    RodProblem stiff = pair_of({.kappa = 1e4});
    stiff.t_end = 0.5;
    CHECK(simulate(stiff, options_of({Formulation::dae, Method::bdf}, 1e-11)).solution.status.ok());
}

TEST_CASE("method auto takes BDF for stiff headings only") {
    const auto pair = [](double kappa) {
        return rods::RodProblem{
            elastic::Medium{}, {.kappa = kappa}, {{0, 2.5, 0}, {0, -2.5, 0}}, 1.0, {}, {}};
    };
    CHECK(rods::suitable_method(pair(0.5)) == integrate::Method::erk);
    CHECK(rods::suitable_method(pair(100.0)) == integrate::Method::erk);
    CHECK(rods::suitable_method(pair(1e4)) == integrate::Method::bdf);
    CHECK(rods::stiffness(pair(0.0)) == 0.0);
    CAPTURE(rods::stiffness(pair(100.0)), rods::stiffness(pair(1e4)));
    CHECK(rods::stiffness(pair(1e4)) == Approx(100.0 * rods::stiffness(pair(100.0)))); // linear in kappa
}
