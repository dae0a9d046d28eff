// Runs on the mesh against runs by sums.

#include "reference_run.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

/// Rods on a grid in a box of 12, with headings all around.
MediumProblem crowd(bool self_field, Evaluation evaluation, double kappa) {
    MediumProblem p;
    p.rods.medium = elastic::Medium{1.0, 1.0};
    p.rods.couplings = {kappa, 0.0, 0.0};
    for (int k = 0; k < 9; ++k)
        p.rods.rods.push_back({4.0 * (k % 3), 4.0 * (k / 3) + 0.3 * (k % 2), 2.4 * k});
    p.rods.t_end = 3.0;
    p.medium = {
        .box = 12.0, .force_width = 0.8, .modes = 28, .self_field = self_field, .evaluation = evaluation};
    return p;
}

MediumResult run(const MediumProblem& problem, double rtol) {
    rods::RodOptions options;
    options.ode.rtol = rtol;
    options.ode.atol = 0.01 * rtol;
    return simulate(problem, options);
}

/// Largest difference of the headings after the runs.
double turned_apart(const rods::RodResult& a, const rods::RodResult& b) {
    double largest = 0.0;
    for (std::size_t rod = 0; rod < a.outcome.turn.size(); ++rod)
        largest = std::max(largest, std::abs(a.outcome.turn[rod] - b.outcome.turn[rod]));
    return largest;
}

} // namespace

TEST_CASE("in one field for all the mesh gives the same run as sums, to the tolerance") {
    for (const rods::Coupling& coupling : rods::coupling_list) { // each alone
        INFO(std::string(coupling.name));
        const auto result = [&](Evaluation evaluation) {
            MediumProblem problem = crowd(true, evaluation, 0.0);
            problem.rods.couplings.*coupling.number = 3.0;
            return run(problem, 1e-8);
        };
        const MediumResult sums = result(Evaluation::sums), mesh = result(Evaluation::mesh);
        CHECK(tests::distance(sums.solution.final_state, mesh.solution.final_state) < 1e-7);
        double turn = 0.0;
        for (const double t : mesh.outcome.turn)
            turn = std::max(turn, std::abs(t));
        CHECK(turn > 0.1);
        CHECK(sums.own_turn.size() == 9);
        CHECK(mesh.own_turn.empty());
    }
}

TEST_CASE("without a rod's own field the mesh is nearer to separate fields than the field of all, by far") {
    const auto result = [](bool self_field, Evaluation evaluation) {
        MediumProblem problem = crowd(self_field, evaluation, 3.0);
        problem.rods.rods.resize(5);
        problem.medium.box = 24.0; // a rod's own images stay in
        problem.medium.modes = 56;
        return run(problem, 1e-6);
    };
    const rods::RodResult separate = result(false, Evaluation::sums), mesh = result(false, Evaluation::mesh),
                          all = result(true, Evaluation::mesh);
    const double off = turned_apart(mesh, separate), with_own = turned_apart(all, separate);
    CAPTURE(off, with_own);
    CHECK(with_own > 1e-2);
    CHECK(off < 0.1 * with_own);
}

TEST_CASE("a run on the mesh is taken up again to the bit, on any number of threads", "[threads]") {
    MediumProblem problem = crowd(false, Evaluation::mesh, 3.0);
    const rods::RodResult whole = run(problem, 1e-6);
    rods::RodOptions options;
    options.ode.rtol = 1e-6;
    options.ode.atol = 1e-8;
    options.ode.segment_steps = 5;
    std::optional<rods::RodCheckpoint> kept;
    options.on_checkpoint = [&](const rods::RodCheckpoint& checkpoint) { kept = checkpoint; };
    options.ode.stop_requested = [&] { return kept.has_value(); };
    simulate(problem, options);
    REQUIRE(kept.has_value());
    CHECK(kept->state.size() == state_size(problem.medium, 9));
    options.resume_from = kept;
    options.on_checkpoint = nullptr;
    options.ode.stop_requested = nullptr;
    problem.rods.sums.threads = 2;
    const rods::RodResult rest = simulate(problem, options);
    CHECK(rest.solution.final_state == whole.solution.final_state);
    CHECK(rest.solution.statistics.steps == whole.solution.statistics.steps);
}
