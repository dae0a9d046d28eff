// Runs: against another integrator, to contact, resumed, over threads.

#include "reference_run.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

MediumProblem pair(bool self_field, Start start) {
    MediumProblem p;
    p.rods.medium = elastic::Medium{1.0, 1.0};
    p.rods.couplings = {3.0, 1.0, -0.5};
    p.rods.rods = {{0.0, 1.5, -0.1}, {0.3, -1.5, 0.2}};
    p.rods.t_end = 4.0;
    p.medium = {.box = 8.0, .force_width = 0.6, .modes = 16, .self_field = self_field, .start = start};
    return p;
}

rods::RodOptions tolerance(double rtol) {
    rods::RodOptions options;
    options.ode.rtol = rtol;
    options.ode.atol = 0.01 * rtol;
    return options;
}

/// Side by side; they meet.
MediumProblem meeting() {
    MediumProblem p = pair(false, Start::steady);
    p.rods.couplings = {30.0, 0.0, 0.0};
    p.rods.rods = {{0.0, 1.5, 0.0}, {0.0, -1.5, 0.0}};
    p.rods.t_end = 20.0;
    p.rods.output_times = {0.0, 1.0, 2.5};
    p.rods.contact_distance = 0.5;
    return p;
}

/// Rods with bodies whose courses cross.
MediumProblem touching(double kappa, double alpha = 1.0) {
    MediumProblem p = pair(false, Start::steady);
    p.rods.medium = elastic::Medium{1.0, 1.0 / alpha};
    p.rods.couplings = {kappa, 0.0, 0.0};
    p.rods.rods = {{-1.2, 0.0, 0.0}, {0.1, -1.2, 1.4}};
    p.rods.bodies.shapes = {rods::BodyShape{}};
    p.rods.t_end = 3.0;
    return p;
}

} // namespace

TEST_CASE("rods that start within the contact distance are in contact at 0, however near") {
    for (const Closure closure : {Closure::none, Closure::steady})
        for (const double y : {-1.5, 1.2, 1.5}) { // 1.5: in one place
            MediumProblem problem = meeting();
            problem.medium.closure = closure;
            problem.rods.rods[1].y = y;
            problem.rods.contact_distance = 4.0;
            const MediumResult result = simulate(problem, {});
            CHECK(result.outcome.ending == Ending::contact);
            CHECK(result.outcome.time == 0.0);
            CHECK(result.outcome.min_separation == 1.5 - y);
            CHECK(result.solution.times == std::vector{0.0});
        }
}

TEST_CASE("a turning pair is that of another integrator to 1e-7") {
    for (const bool remembers : {false, true}) {
        const MediumProblem problem = pair(remembers, remembers ? Start::rest : Start::steady);
        const std::vector<double> reference =
            tests::reference_run(problem, 1000); // to 2e-10, by halving its step
        const rods::RodResult result = simulate(problem, tolerance(1e-8));
        CAPTURE(remembers);
        REQUIRE(std::abs(reference[2] + 0.1) > 0.05); // it turns
        CHECK(tests::distance(result.solution.final_state, reference) < 1e-7);
        CHECK(tests::distance(simulate(problem, tolerance(1e-11)).solution.final_state, reference) < 1e-9);
    }
}

TEST_CASE("states inside a step are as good as those at its ends") {
    MediumProblem problem = pair(false, Start::steady);
    for (int i = 1; i < 200; ++i)
        problem.rods.output_times.push_back(0.02 * i);
    const rods::RodResult rough = simulate(problem, tolerance(1e-7)),
                          fine = simulate(problem, tolerance(1e-11));
    REQUIRE(rough.solution.statistics.steps < 80);
    for (std::size_t i = 0; i < rough.solution.states.size(); ++i)
        CHECK(tests::distance(rough.solution.states[i], fine.solution.states[i]) < 1e-6);
}

TEST_CASE("a run stops at contact, at the contact distance") {
    const rods::RodResult result = simulate(meeting(), tolerance(1e-8)),
                          fine = simulate(meeting(), tolerance(1e-11));
    CHECK(result.outcome.ending == Ending::contact);
    CHECK(result.outcome.min_separation == Approx(0.5).epsilon(1e-12));
    CHECK(result.outcome.time == Approx(fine.outcome.time).epsilon(1e-7));
    CHECK(result.outcome.time < 20.0);
    CHECK(result.solution.times == std::vector<double>{0.0, 1.0, 2.5});
    CHECK(result.solution.final_time == result.outcome.time);
    // mirror images of each other
    const std::vector<double>& y = result.solution.final_state;
    CHECK(y[0] == Approx(y[3]).epsilon(1e-10));
    CHECK(y[1] == Approx(-y[4]).epsilon(1e-10));
}

TEST_CASE("a run that is taken up again goes on to the bit, on any number of threads", "[threads]") {
    MediumProblem problem = meeting();
    rods::RodOptions options = tolerance(1e-8);
    options.ode.segment_steps = 10;
    const rods::RodResult whole = simulate(problem, options);
    std::optional<rods::RodCheckpoint> kept;
    options.on_checkpoint = [&](const rods::RodCheckpoint& checkpoint) { kept = checkpoint; };
    options.ode.stop_requested = [&] { return kept.has_value(); };
    const rods::RodResult part = simulate(problem, options);
    REQUIRE(kept.has_value());
    CHECK(part.solution.status.termination == integrate::Termination::interrupted);
    CHECK(kept->state.size() == state_size(problem.medium, 2));
    options.resume_from = kept;
    options.on_checkpoint = nullptr;
    options.ode.stop_requested = nullptr;
    problem.rods.sums.threads = 2;
    const rods::RodResult rest = simulate(problem, options);
    CHECK(rest.solution.final_time == whole.solution.final_time);
    CHECK(rest.solution.final_state == whole.solution.final_state);
    CHECK(rest.solution.states == whole.solution.states);
    CHECK(rest.solution.statistics.steps == whole.solution.statistics.steps);
    CHECK(rest.outcome.min_separation == whole.outcome.min_separation);
}

TEST_CASE("few modes get one thread, many as many as have work", "[threads]") {
    const auto threads = [](std::size_t modes, std::size_t rods, Evaluation evaluation, std::size_t most) {
        DynamicMedium medium;
        medium.modes = modes;
        medium.evaluation = evaluation;
        return worthwhile_threads(medium, rods, most);
    };
    CHECK(threads(32, 2, Evaluation::sums, 8) == 1);
    CHECK(threads(32, 100, Evaluation::mesh, 8) == 1);
    CHECK(threads(384, 2, Evaluation::sums, 2) == 2);
    CHECK(threads(384, 100, Evaluation::mesh, 2) == 2);
    CHECK(threads(384, 100, Evaluation::mesh, 1) == 1);
    CHECK(threads(32, 10'000, Evaluation::mesh, 2) == 2); // here the rods are the work
}

TEST_CASE("a single rod turns in its own memory alone") {
    MediumProblem problem = pair(false, Start::rest);
    problem.rods.rods.resize(1);
    CHECK(simulate(problem, tolerance(1e-8)).outcome.turn[0] == 0.0);
    problem.medium.self_field = true;
    const std::vector<double> reference = tests::reference_run(problem, 800);
    const rods::RodResult result = simulate(problem, tolerance(1e-8));
    CHECK(std::abs(result.outcome.turn[0]) > 1e-6); // the box's images, askew to the heading
    CHECK(tests::distance(result.solution.final_state, reference) < 1e-7);
}

TEST_CASE("a turning pair in a medium with inertia is that of another integrator to 1e-7") {
    for (const bool remembers : {false, true}) {
        MediumProblem problem = pair(remembers, remembers ? Start::rest : Start::steady);
        problem.medium.inertia = remembers ? 0.8 : 0.1;
        problem.rods.t_end = 2.0;
        const std::vector<double> reference = tests::reference_waves(problem, 800);
        CAPTURE(remembers);
        MediumProblem without = problem;
        without.medium.inertia = 0.0;
        CHECK(tests::distance(simulate(without, tolerance(1e-6)).solution.final_state, reference) > 1e-3);
        CHECK(tests::distance(simulate(problem, tolerance(1e-8)).solution.final_state, reference) < 1e-7);
    }
}

TEST_CASE("what a rod's own field turned it by is distinguished, also by a run that was taken up again") {
    MediumProblem problem = pair(true, Start::rest);
    problem.rods.rods.resize(1);
    const MediumResult alone = simulate(problem, tolerance(1e-8));
    REQUIRE(alone.own_turn.size() == 1);
    CHECK(alone.own_turn[0] ==
          Approx(alone.outcome.turn[0]).epsilon(1e-4)); // there is nothing else; Simpson's rule

    problem = pair(true, Start::steady);
    const MediumResult whole = simulate(problem, tolerance(1e-8));
    CHECK(std::abs(whole.own_turn[0]) > 1e-4);
    CHECK(std::abs(whole.own_turn[0] - whole.outcome.turn[0]) > 1e-2);
    CHECK(simulate(problem, tolerance(1e-10)).own_turn[0] == Approx(whole.own_turn[0]).epsilon(1e-5));
    rods::RodOptions options = tolerance(1e-8);
    std::optional<rods::RodCheckpoint> kept;
    options.ode.segment_steps = 10;
    options.on_checkpoint = [&](const rods::RodCheckpoint& checkpoint) { kept = checkpoint; };
    options.ode.stop_requested = [&] { return kept.has_value(); };
    CHECK(simulate(problem, options).own_turn[0] != whole.own_turn[0]);
    REQUIRE(kept.has_value());
    CHECK(kept->state.size() == state_size(problem.medium, 2));
    options.resume_from = kept;
    options.on_checkpoint = nullptr;
    options.ode.stop_requested = nullptr;
    CHECK(simulate(problem, options).own_turn == whole.own_turn);
    CHECK(simulate(pair(false, Start::steady), tolerance(1e-6)).own_turn.empty());
}

TEST_CASE("a run that may take no more steps says so") {
    rods::RodOptions options = tolerance(1e-8);
    options.ode.max_steps = 3;
    const rods::RodResult result = simulate(meeting(), options);
    CHECK(result.solution.status.termination == integrate::Termination::failed);
    CHECK(result.solution.status.flag == "TOO_MANY_STEPS");
    CHECK(result.outcome.ending == Ending::undecided);
}

TEST_CASE("bodies push rods in any field as they do without one") {
    MediumProblem problem = touching(0.0);
    rods::RodProblem alone = problem.rods;
    alone.box = problem.medium.box;
    rods::RodOptions options = tolerance(1e-10);
    options.ode.method = integrate::Method::erk;
    const rods::RodResult expected = rods::simulate(alone, options);
    REQUIRE(expected.outcome.min_gap < 0.0);
    const auto compare = [&](const rods::RodResult& wanted) {
        const rods::RodResult result = simulate(problem, tolerance(1e-8));
        CHECK(result.outcome.ending == wanted.outcome.ending);
        CHECK(result.outcome.time == Approx(wanted.outcome.time).epsilon(1e-7));
        CHECK(result.outcome.min_gap == Approx(wanted.outcome.min_gap).epsilon(1e-3));
        CHECK(result.outcome.min_separation == Approx(wanted.outcome.min_separation).epsilon(1e-6));
        CHECK(tests::distance(result.solution.final_state, wanted.solution.final_state) < 1e-6);
    };
    compare(expected);
    for (const Evaluation evaluation : {Evaluation::sums, Evaluation::mesh}) {
        problem.medium.self_field = true;
        problem.medium.evaluation = evaluation;
        compare(expected);
    }
    // contact is between centres, and rods that are pushed come to it by other ways than their headings'
    alone.contact_distance = problem.rods.contact_distance = expected.outcome.min_separation + 0.05;
    const rods::RodResult met = rods::simulate(alone, options);
    REQUIRE(met.outcome.ending == Ending::contact);
    compare(met);
    problem.rods.contact_distance.reset();
    problem.medium.self_field = false; // on the mesh: own fields are known of rods that walk straight
    CHECK_THROWS_WITH(simulate(problem, {}),
                      Catch::Contains("take self_field = true, or sums for at most 64"));
}

TEST_CASE("where fields follow at once bodies move as in the closure") {
    const auto error = [](double alpha) {
        MediumProblem problem = touching(3.0, alpha);
        const MediumResult memory = simulate(problem, tolerance(1e-8));
        problem.medium.closure = Closure::steady;
        const MediumResult closed = simulate(problem, tolerance(1e-8));
        CHECK(memory.outcome.min_gap < 0.0);
        CHECK(memory.outcome.min_gap == Approx(closed.outcome.min_gap).margin(alpha));
        return tests::distance(memory.solution.final_state, closed.solution.final_state);
    };
    const double coarse = error(0.04), fine = error(0.02);
    CHECK(fine < 0.02);
    CHECK(coarse / fine == Approx(2.0).margin(0.2)); // of first order in alpha
}
