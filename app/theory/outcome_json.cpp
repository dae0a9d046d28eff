#include "run/stage_list.hpp"

#include <nlohmann/json.hpp>

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

nlohmann::ordered_json solver_json(const rods::RodResult& result, const RodsPlan& plan,
                                   const OutputUnits& units) {
    const integrate::OdeOptions& ode = plan.options.ode;
    const integrate::Statistics& n = result.solution.statistics;
    nlohmann::ordered_json solver;
    solver["method"] = plan.noise ? "noise, strong order 1.5" : method_name(plan);
    solver["form"] = to_string(plan.options.form);
    solver["field"] = to_string(plan.field.backend);
    if (plan.field.backend == scene::FieldBackend::dynamic) // which of the two "auto" comes to
        solver["evaluation"] = medium::evaluation_of(plan.of.scene.medium->memory(),
                                                     plan.problem.rods.size()) == medium::Evaluation::mesh
                                   ? "mesh"
                                   : "sums";
    if (plan.field.tolerance > 0.0)
        solver["field_tolerance"] = plan.field.tolerance;
    if (!plan.field.why.empty())
        solver["field_chosen"] = plan.field.why;
    if (plan.noise) {
        solver["run"] = 0; // of noise.runs
        solver["time_step"] = plan.noise->noise.time_step * units.time;
    } else {
        solver["rtol"] = ode.rtol;
        solver["atol"] = ode.atol;
    }
    solver["status"] = to_string(result.solution.status.termination);
    solver["steps"] = n.steps;
    solver["rhs_evaluations"] = n.rhs_evaluations;
    solver["jacobian_evaluations"] = n.jacobian_evaluations;
    solver["error_test_failures"] = n.error_test_failures;
    solver["convergence_failures"] = n.convergence_failures;
    if (plan.options.form != rods::Form::angle) // the largest ||n| - 1| after a step
        solver["director_drift"] = n.drift;
    if (!result.solution.status.ok())
        solver["message"] = result.solution.status.message();
    return solver;
}

} // namespace

std::string outcome_json(const rods::RodResult& result, const RodsPlan& plan, const OutputUnits& units,
                         const nlohmann::ordered_json& ensemble, const std::vector<double>& own_turn) {
    const rods::RodOutcome& outcome = result.outcome;
    nlohmann::ordered_json json;
    json["outcome"] = to_string(outcome.ending);
    json["time"] = outcome.time * units.time;
    if (std::isfinite(outcome.min_separation)) {
        json["min_separation"] = outcome.min_separation * units.length;
        json["min_separation_time"] = outcome.min_separation_time * units.time;
        json["pair"] = {outcome.pair.first, outcome.pair.second};
    } else {
        json["min_separation"] = nullptr;
        json["min_separation_time"] = nullptr;
        json["pair"] = nullptr;
    }
    json["turn"] = outcome.turn;
    if (!own_turn.empty()) // of turn, by the rod's own field
        json["own_turn"] = own_turn;
    json["reason"] = outcome.reason;
    json["units"] = {{"length", units.length_name}, {"time", units.time_name}, {"turn", "rad"}};
    json["solver"] = solver_json(result, plan, units);
    if (!ensemble.is_null())
        json["ensemble"] = ensemble;
    return json.dump(2) + "\n";
}

} // namespace rodwake::app
