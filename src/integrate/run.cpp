#include "run.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace rodwake::integrate {

namespace {

std::unique_ptr<Stepper> make_stepper(UserFunctions& calls, const OdeOptions& options, double end_time) {
    if (std::ranges::count(calls.problem().algebraic, true) > 0)
        return make_ida_stepper(calls, options, end_time);
    if (options.method != Method::erk)
        return make_cvode_stepper(calls, options, end_time);
    const bool small = calls.problem().initial_state.size() <= most_small;
    return small ? make_small_erk_stepper(calls, options, end_time)
                 : make_erk_stepper(calls, options, end_time);
}

} // namespace

Run::Run(const OdeProblem& problem, const SensitivityProblem* sensitivity, const OdeOptions& options,
         std::span<const double> output_times)
    : options_(options), output_times_(output_times), calls_(problem, options, sensitivity),
      stepper_(make_stepper(calls_, options, output_times.back())) {}

SensitivitySolution Run::execute() {
    solution_.times.reserve(output_times_.size());
    solution_.states.reserve(output_times_.size());
    const double t = calls_.problem().start_time;
    const State y = calls_.problem().initial_state;
    stepper_->start(t, y);
    store_outputs(t);
    bool going = true;
    try {
        events_.emplace(calls_, t, y);
    } catch (const StepFailure& failure) {
        going = fail(failure, t, y);
    }
    if (going && all_stored())
        going = end(Termination::reached_end, t, y);
    while (going && advance() && digest_step()) {
        // After a step: the end, a new segment, or the caller's wish to stop.
        if (all_stored()) {
            end(Termination::reached_end, stepper_->time(), stepper_->state());
            break;
        }
        if (steps_ % options_.segment_steps == 0 && steps_ < options_.max_steps) {
            stepper_->limit_next_step(std::numeric_limits<double>::infinity()); // a part of the history
            stepper_->start(stepper_->time(), stepper_->state());
            if (options_.on_segment)
                options_.on_segment({stepper_->time(), stepper_->state(), solution_.states, statistics()});
        }
        if (options_.stop_requested && options_.stop_requested())
            going = end(Termination::interrupted, stepper_->time(), stepper_->state());
    }
    solution_.statistics = statistics();
    return std::move(result_);
}

Statistics Run::statistics() const {
    Statistics counts = stepper_->counts();
    counts.rhs_evaluations = calls_.rhs_evaluations();
    counts.event_evaluations = calls_.event_evaluations();
    counts.drift = calls_.drift();
    return counts;
}

bool Run::advance() {
    constexpr long most_stalled = 10; // a few such steps can precede a recovery
    const bool may_step = steps_ < options_.max_steps;
    if (!may_step)
        return fail({"TOO_MUCH_WORK", ""}, stepper_->time(), stepper_->state());
    if (!stepper_->advance())
        return fail(stepper_->failure(), stepper_->time(), stepper_->state());
    calls_.clear_fault();
    ++steps_;
    stalled_steps_ = stepper_->time() > stepper_->time_before() ? 0 : stalled_steps_ + 1;
    if (stalled_steps_ < most_stalled)
        return true;
    return fail({"STEP_BELOW_ROUNDOFF", ""}, stepper_->time(), stepper_->state());
}

/// Stores what the last step holds, up to its first terminal event.
bool Run::digest_step() {
    std::vector<EventHit> hits;
    const EventHit* stop = nullptr;
    try {
        hits = events_->in_last_step(*stepper_, output_times_.subspan(solution_.times.size()));
        for (const EventHit& hit : hits)
            if (!stop && calls_.problem().events[hit.event].terminal)
                stop = &hit;
        store_outputs(stop ? stop->time : stepper_->time());
        if (stop && calls_.sensitivity())
            result_.event_time_by_parameter = event_time_by_parameter(*stop);
    } catch (const StepFailure& failure) {
        return fail(failure, stepper_->time_before(), stepper_->state_before());
    }
    if (options_.on_step) { // a step that a terminal event cut short ends there
        Step step = stepper_->step();
        if (stop) {
            step.time = stop->time;
            step.state = stop->state;
        }
        options_.on_step(step);
    }
    const bool going = stop ? end(Termination::stopped_at_event, stop->time, stop->state) : true;
    std::move(hits.begin(), hits.end(), std::back_inserter(solution_.hits));
    return going;
}

bool Run::end(Termination termination, double t, State state) {
    solution_.final_time = t;
    solution_.final_state.assign(state.begin(), state.end());
    solution_.status.termination = termination;
    solution_.status.reached = t;
    solution_.status.wanted = output_times_.back();
    solution_.status.step = stepper_->time() - stepper_->time_before();
    solution_.status.order = stepper_->order();
    if (calls_.sensitivity())
        result_.final_sensitivity = stepper_->sensitivities(t);
    return false;
}

bool Run::fail(const StepFailure& failure, double reached, State state) {
    end(Termination::failed, reached, state);
    describe_failure(failure, *stepper_, calls_, solution_.status);
    return false;
}

void Run::store_outputs(double until) {
    while (!all_stored() && output_times_[solution_.times.size()] <= until) {
        const double t = output_times_[solution_.times.size()];
        const State last = stepper_->state();
        std::vector<double> state(last.begin(), last.end());
        if (t < stepper_->time())
            stepper_->interpolate(t, state);
        solution_.states.push_back(std::move(state));
        solution_.times.push_back(t);
        if (calls_.sensitivity())
            result_.sensitivities.push_back(stepper_->sensitivities(t));
    }
}

/// From g(y(t, p), p) = 0: grad g . (S + f dt/dp) + dg/dp = 0.
Eigen::VectorXd Run::event_time_by_parameter(const EventHit& hit) {
    const auto n = static_cast<Eigen::Index>(hit.state.size());
    const Eigen::VectorXd gradient = calls_.event_gradient(hit.event, hit.time, hit.state);
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(n);
    if (calls_.rhs(hit.time, hit.state, {slope.data(), hit.state.size()}) != UserFunctions::fine)
        throw StepFailure{"RHSFUNC_FAIL", calls_.fault()};
    const Eigen::VectorXd by_state = gradient.head(n);
    Eigen::VectorXd by_parameter = stepper_->sensitivities(hit.time).transpose() * by_state;
    if (gradient.size() > n)
        by_parameter += gradient.tail(gradient.size() - n);
    return -by_parameter / by_state.dot(slope);
}

Solution solve(const OdeProblem& problem, const OdeOptions& options, std::span<const double> output_times) {
    check_problem(problem, options, output_times);
    return Run(problem, nullptr, options, output_times).execute().solution;
}

} // namespace rodwake::integrate
