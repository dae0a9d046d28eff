#include "describe_failure.hpp"
#include "rodwake/integrate/ode.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace rodwake::integrate {

Statistics& Statistics::operator+=(const Statistics& other) {
    steps += other.steps;
    rhs_evaluations += other.rhs_evaluations;
    jacobian_evaluations += other.jacobian_evaluations;
    error_test_failures += other.error_test_failures;
    convergence_failures += other.convergence_failures;
    event_evaluations += other.event_evaluations;
    return *this;
}

namespace {

/// The ten largest, by name; those a thousand times below the largest say nothing, NaN is the worst of all.
std::vector<Status::Component> worst_components(const std::vector<double>& errors,
                                                const ProblemCalls& calls) {
    auto rank = [&](std::size_t i) { return std::isnan(errors[i]) ? HUGE_VAL : errors[i]; };
    std::vector<std::size_t> order(errors.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return rank(a) > rank(b); });
    const double least = order.empty() || std::isinf(rank(order[0])) ? 0.0 : 1e-3 * rank(order[0]);
    std::vector<Status::Component> worst;
    for (std::size_t i : order)
        if (rank(i) > least && worst.size() < 10)
            worst.push_back({calls.component_name(i), errors[i]});
    return worst;
}

std::string failure_message(const Status& status) {
    std::string text =
        fmt::format("integration stopped at t={} of {} ({}, step {:.3g}, order {}): {}.", status.reached,
                    status.wanted, status.flag, status.step, status.order, status.cause);
    if (!status.worst.empty())
        text += " Worst local errors over tolerance:";
    for (std::size_t i = 0; i < status.worst.size(); ++i)
        text +=
            fmt::format("{} {} {:.2g}", i ? "," : "", status.worst[i].name, status.worst[i].weighted_error);
    if (!status.worst.empty())
        text += ".";
    return text + " Try: " + status.advice + ".";
}

} // namespace

void describe_failure(const StepFailure& failure, const Stepper& stepper, const ProblemCalls& calls,
                      Status& status) {
    const Remedy remedy = remedy_for(failure.flag);
    const double tried = calls.last_time() - stepper.time();
    if (tried > 0.0)
        status.step = tried;
    status.flag = stepper.flag_prefix() + "_" + failure.flag;
    status.advice = remedy.advice;
    status.cause = failure.cause;
    if (!failure.cause.empty())
        return; // a function failed, not the step: error estimates would mislead
    status.cause = remedy.cause ? remedy.cause : stepper.solver_text();
    status.worst = worst_components(stepper.weighted_errors(), calls);
}

std::string Status::message() const {
    switch (outcome) {
    case Outcome::failed:
        return failure_message(*this);
    case Outcome::reached_end:
        return fmt::format("integration reached t={}", reached);
    case Outcome::stopped_at_event:
        return fmt::format("integration stopped by an event at t={} of {}", reached, wanted);
    case Outcome::interrupted:
        break;
    }
    return fmt::format("integration interrupted at t={} of {}", reached, wanted);
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
