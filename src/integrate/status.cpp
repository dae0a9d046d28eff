// How a solve ended, in words: what each solver flag usually means and what to do about it. tests/integrate
// provokes the reachable ones.

#include "rodwake/integrate/ode.hpp"

#include "stepper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string_view>

namespace rodwake::integrate {

namespace {

/// Likely cause and remedy of a SUNDIALS flag, its prefix removed. Flags without an entry have no cause here.
struct Remedy {
    const char* cause; ///< or null
    const char* advice;
};

struct StatusEntry {
    std::string_view flag;
    Remedy remedy;
};

constexpr const char* look_at_rhs =
    "check the model at that time and state; set max_step if it is only defined near the solution";

constexpr std::array entries{
    StatusEntry{"TOO_MUCH_WORK",
                {"the steps allowed were used up", "raise max_steps, loosen rtol, or use method bdf if the "
                                                   "problem is stiff"}},
    StatusEntry{"TOO_MUCH_ACC",
                {"the tolerances are below the precision of the arithmetic", "loosen rtol or raise atol"}},
    StatusEntry{"ERR_FAILURE",
                {"no step was short enough for the tolerances: the right-hand side jumps or is singular here",
                 "raise atol for the components named, loosen rtol, or stop earlier by an event (a larger "
                 "contact distance)"}},
    StatusEntry{"CONV_FAILURE",
                {"the implicit equation of the step did not converge: stiff problem, or a wrong Jacobian",
                 "use method bdf, check the Jacobian against difference quotients, or tighten rtol"}},
    StatusEntry{"LSETUP_FAIL", {"the Jacobian could not be set up", "check the Jacobian at that time"}},
    StatusEntry{"LSOLVE_FAIL",
                {"the linear system of the step could not be solved", "check the Jacobian at that time"}},
    StatusEntry{"RHSFUNC_FAIL", {"the right-hand side failed", look_at_rhs}},
    StatusEntry{"FIRST_RHSFUNC_ERR", {"the right-hand side failed at the start", "check the initial state"}},
    StatusEntry{"REPTD_RHSFUNC_ERR",
                {"the right-hand side kept failing even for the shortest step", look_at_rhs}},
    StatusEntry{"UNREC_RHSFUNC_ERR",
                {"the right-hand side kept failing even for the shortest step", look_at_rhs}},
    StatusEntry{"SRHSFUNC_FAIL", {"the derivatives of the right-hand side failed", look_at_rhs}},
    StatusEntry{"FIRST_SRHSFUNC_ERR",
                {"the derivatives of the right-hand side failed at the start", "check the initial state"}},
    StatusEntry{
        "REPTD_SRHSFUNC_ERR",
        {"the derivatives of the right-hand side kept failing even for the shortest step", look_at_rhs}},
    StatusEntry{
        "UNREC_SRHSFUNC_ERR",
        {"the derivatives of the right-hand side kept failing even for the shortest step", look_at_rhs}},
    StatusEntry{"RTFUNC_FAIL", {"an event function failed", "check the event function at that time"}},
    StatusEntry{"REP_RES_ERR", {"the equations kept failing even for the shortest step", look_at_rhs}},
    StatusEntry{"RES_FAIL", {"the equations failed", look_at_rhs}},
    StatusEntry{"FIRST_RES_FAIL", {"the equations failed at the start", "check the initial state"}},
    StatusEntry{"NO_RECOVERY", {"no consistent initial values were found", "check the initial state"}},
    StatusEntry{"CONV_FAIL",
                {"the implicit equation of the step did not converge", "tighten rtol, or use another form"}},
    StatusEntry{"ERR_FAIL",
                {"no step was short enough for the tolerances: the equations jump or are singular here",
                 "loosen rtol, or stop earlier by an event (a larger contact distance)"}},
    StatusEntry{"STEP_BELOW_ROUNDOFF",
                {"the step no longer changes the time: the solution is singular here",
                 "loosen rtol, or stop earlier by an event (a larger contact distance)"}},
};

} // namespace

Statistics& Statistics::operator+=(const Statistics& other) {
    steps += other.steps;
    rhs_evaluations += other.rhs_evaluations;
    jacobian_evaluations += other.jacobian_evaluations;
    error_test_failures += other.error_test_failures;
    convergence_failures += other.convergence_failures;
    event_evaluations += other.event_evaluations;
    drift = std::max(drift, other.drift);
    return *this;
}

void describe_failure(const StepFailure& failure, const Stepper& stepper, const UserFunctions& calls,
                      Status& status) {
    const auto entry = std::ranges::find(entries, failure.flag, &StatusEntry::flag);
    const Remedy remedy =
        entry != entries.end() ? entry->remedy : Remedy{nullptr, "try another method, or loosen rtol"};
    const double tried = calls.last_time() - stepper.time();
    if (tried > 0.0)
        status.step = tried;
    status.flag = stepper.flag_prefix() + "_" + failure.flag;
    status.advice = remedy.advice;
    status.cause = failure.cause;
    if (!failure.cause.empty())
        return; // a function failed, not the step: error estimates would mislead
    status.cause = remedy.cause ? remedy.cause : stepper.solver_text();
    // The ten largest, by name; those a thousand times below the largest say nothing, NaN is the worst of
    // all.
    const std::vector<double>& errors = stepper.weighted_errors();
    auto rank = [&](std::size_t i) { return std::isnan(errors[i]) ? HUGE_VAL : errors[i]; };
    std::vector<std::size_t> order(errors.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return rank(a) > rank(b); });
    const double least = order.empty() || std::isinf(rank(order[0])) ? 0.0 : 1e-3 * rank(order[0]);
    for (std::size_t i : order)
        if (rank(i) > least && status.worst.size() < 10)
            status.worst.push_back({calls.component_name(i), errors[i]});
}

std::string Status::message() const {
    switch (termination) {
    case Termination::failed:
        break;
    case Termination::reached_end:
        return fmt::format("integration reached t={}", reached);
    case Termination::stopped_at_event:
        return fmt::format("integration stopped by an event at t={} of {}", reached, wanted);
    case Termination::interrupted:
        return fmt::format("integration interrupted at t={} of {}", reached, wanted);
    }
    std::string text = fmt::format("integration stopped at t={} of {} ({}, step {:.3g}, order {}): {}.",
                                   reached, wanted, flag, step, order, cause);
    if (!worst.empty())
        text += " Worst local errors over tolerance:";
    for (std::size_t i = 0; i < worst.size(); ++i)
        text += fmt::format("{} {} {:.2g}", i ? "," : "", worst[i].name, worst[i].weighted_error);
    if (!worst.empty())
        text += ".";
    return text + " Try: " + advice + ".";
}

const char* to_string(Termination termination) {
    switch (termination) {
    case Termination::reached_end:
        return "reached_end";
    case Termination::stopped_at_event:
        return "stopped_at_event";
    case Termination::interrupted:
        return "interrupted";
    case Termination::failed:
        break;
    }
    return "failed";
}

std::string to_string(Method method) {
    switch (method) {
    case Method::bdf:
        return "bdf";
    case Method::adams:
        return "adams";
    case Method::erk:
        break;
    }
    return "erk";
}

} // namespace rodwake::integrate
