#include "rods_ensemble.hpp"
#include "run/record_json.hpp"

#include <cmath>

namespace rodwake::app {

namespace {

std::string method_name(const RodsPlan& plan) {
    if (plan.field.backend != scene::FieldBackend::dynamic)
        return integrate::to_string(plan.options.ode.method);
    return plan.of.scene.medium->memory().closure == medium::Closure::none
               ? "etdrk4"
               : integrate::to_string(integrate::Method::erk); // medium/simulate.hpp
}

SolverReport solver_report(const rods::RodResult& result, const RodsPlan& plan, const OutputUnits& units) {
    const integrate::OdeOptions& ode = plan.options.ode;
    const integrate::Statistics& n = result.solution.statistics;
    SolverReport solver;
    solver.method = plan.noise ? "noise, strong order 1.5" : method_name(plan);
    solver.form = to_string(plan.options.form);
    solver.field_name = to_string(plan.field.backend);
    if (plan.field.backend == scene::FieldBackend::dynamic) // which of the two "auto" comes to
        solver.evaluation = medium::evaluation_of(plan.of.scene.medium->memory(), plan.problem.rods.size()) ==
                                    medium::Evaluation::mesh
                                ? "mesh"
                                : "sums";
    if (plan.field.tolerance > 0.0)
        solver.field_tolerance = plan.field.tolerance;
    if (!plan.field.why.empty())
        solver.field_chosen = plan.field.why;
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
    if (plan.options.form != rods::Form::angle)
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
    report.time = outcome.time * units.time;
    if (std::isfinite(outcome.min_separation)) {
        report.min_separation = outcome.min_separation * units.length;
        report.min_separation_time = outcome.min_separation_time * units.time;
        report.pair = std::array{outcome.pair.first, outcome.pair.second};
    }
    report.turn = outcome.turn;
    if (!own_turn.empty())
        report.own_turn = own_turn;
    report.reason = outcome.reason;
    report.units = {units.length_name, units.time_name, "rad"};
    report.solver = solver_report(result, plan, units);
    report.ensemble = ensemble;
    return record_json(report).dump(2) + "\n";
}

} // namespace rodwake::app
