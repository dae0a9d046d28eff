// outcome.json: how the rods ended, and what the solver did.

#include "rods_ensemble.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/medium/simulate.hpp"
#include "run/record_json.hpp"
#include "wake_fields.hpp"

#include <array>
#include <cmath>

namespace rodwake::app {

namespace {

SolverReport solver_report(const rods::RodResult& result, const RodsPlan& plan, const OutputUnits& units) {
    const integrate::OdeOptions& ode = plan.options.ode;
    const integrate::Statistics& n = result.solution.statistics;
    SolverReport solver;
    if (plan.noise)
        solver.method = "noise, strong order 1.5";
    else if (field_of(plan) != scene::FieldBackend::dynamic)
        solver.method = integrate::to_string(ode.method) + (plan.options.held_wakes ? ", wakes held" : "");
    else // medium/simulate.hpp
        solver.method = plan.of.scene.medium->memory().closure == medium::Closure::none
                            ? "etdrk4"
                            : integrate::to_string(integrate::Method::erk);
    solver.form = to_string(plan.options.form);
    solver.field_name = to_string(field_of(plan));
    if (field_of(plan) == scene::FieldBackend::dynamic) // which of the two "auto" comes to
        solver.evaluation = medium::evaluation_of(plan.of.scene.medium->memory(), plan.problem.rods.size()) ==
                                    medium::Evaluation::mesh
                                ? "mesh"
                                : "sums";
    if (field_of(plan) == scene::FieldBackend::table)
        solver.field_tolerance = plan.of.scene.medium->table.value_or(scene::FieldTable{}).tolerance;
    if (plan.noise) {
        solver.run = 0;
        solver.time_step = plan.noise->noise.time_step * units.time;
    } else {
        solver.rtol = ode.rtol;
        solver.atol = ode.atol;
    }
    solver.status = to_string(result.solution.status.termination);
    solver.steps = n.steps;
    solver.rhs_evaluations = n.rhs_evaluations;
    solver.jacobian_evaluations = n.jacobian_evaluations;
    solver.error_test_failures = n.error_test_failures;
    solver.convergence_failures = n.convergence_failures;
    if (plan.options.form != rods::Formulation::angle)
        solver.director_drift = n.drift;
    if (!result.solution.status.ok())
        solver.message = result.solution.status.message();
    return solver;
}

} // namespace

std::string outcome_json(const rods::RodResult& result, const RodsPlan& plan, const OutputUnits& units,
                         const std::optional<DrawnReport>& ensemble, const std::vector<double>& own_turn) {
    const rods::RodOutcome& outcome = result.outcome;
    OutcomeReport report;
    report.outcome = to_string(outcome.ending);
    report.certificate = to_string(outcome.certificate);
    report.time = outcome.time * units.time;
    if (std::isfinite(outcome.min_separation)) {
        report.min_separation = outcome.min_separation * units.length;
        report.min_separation_time = outcome.min_separation_time * units.time;
        report.pair = std::array{outcome.pair.first, outcome.pair.second};
    }
    if (std::isfinite(outcome.min_gap)) {
        report.min_gap = outcome.min_gap * units.length;
        report.min_gap_time = outcome.min_gap_time * units.time;
    }
    report.turn = outcome.turn;
    if (!own_turn.empty())
        report.own_turn = own_turn;
    if (std::isfinite(outcome.separation))
        report.separation = outcome.separation * units.length;
    if (std::isfinite(outcome.omega))
        report.omega = outcome.omega / units.time;
    report.separation_grows = outcome.grows;
    report.stable = outcome.stable;
    report.reason = outcome.reason;
    report.units = {units.length_name, units.time_name, "rad"};
    report.solver = solver_report(result, plan, units);
    report.ensemble = ensemble;
    return json_text(record_json(report), 2) + "\n";
}

} // namespace rodwake::app
