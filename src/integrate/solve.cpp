// The loop over internal steps: events, outputs, segments, and how it ends.

#include "check_problem.hpp"
#include "describe_failure.hpp"
#include "event_finder.hpp"
#include "stepper.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace rodwake::integrate {

namespace {

std::unique_ptr<Stepper> make_stepper(ProblemCalls& calls, const OdeOptions& options, double end_time) {
    return options.method == Method::erk ? make_erk_stepper(calls, options, end_time)
                                         : make_cvode_stepper(calls, options, end_time);
}

class Run {
public:
    Run(const OdeProblem& problem, const OdeOptions& options, std::span<const double> output_times)
        : options_(options), output_times_(output_times), calls_(problem, options),
          stepper_(make_stepper(calls_, options, output_times.back())) {}

    Solution execute();

private:
    // These say whether the solve goes on; if not, the outcome is set.
    bool start();
    bool advance();
    bool digest_step();
    bool go_on();
    bool end(Outcome outcome, double t, State state);
    bool fail(const StepFailure& failure, double reached, State state);

    void store_outputs(double until);
    std::vector<double> state_at(double t);
    void report_step(const EventHit* end);
    void begin_segment();
    Statistics statistics() const;
    bool all_stored() const { return solution_.times.size() == output_times_.size(); }

    const OdeOptions& options_;
    const std::span<const double> output_times_;
    ProblemCalls calls_;
    std::unique_ptr<Stepper> stepper_;
    std::optional<EventFinder> events_;
    Solution solution_;
    long steps_ = 0, stalled_steps_ = 0;
};

Solution Run::execute() {
    solution_.times.reserve(output_times_.size());
    solution_.states.reserve(output_times_.size());
    bool going = start();
    while (going)
        going = advance() && digest_step() && go_on();
    solution_.statistics = statistics();
    return std::move(solution_);
}

Statistics Run::statistics() const {
    Statistics counts = stepper_->counts();
    counts.rhs_evaluations = calls_.rhs_evaluations();
    counts.event_evaluations = calls_.event_evaluations();
    return counts;
}

bool Run::start() {
    const double t = calls_.problem().start_time;
    const State y = calls_.problem().initial_state;
    stepper_->start(t, y);
    store_outputs(t);
    try {
        events_.emplace(calls_, t, y);
    } catch (const StepFailure& failure) {
        return fail(failure, t, y);
    }
    return all_stored() ? end(Outcome::reached_end, t, y) : true;
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
        hits = events_->in_last_step(*stepper_);
        for (const EventHit& hit : hits)
            if (!stop && calls_.problem().events[hit.event].terminal)
                stop = &hit;
        store_outputs(stop ? stop->time : stepper_->time());
    } catch (const StepFailure& failure) {
        return fail(failure, stepper_->time_before(), stepper_->state_before());
    }
    report_step(stop);
    const bool going = stop ? end(Outcome::stopped_at_event, stop->time, stop->state) : true;
    std::move(hits.begin(), hits.end(), std::back_inserter(solution_.hits));
    return going;
}

/// After a step: the end, a new segment, or the caller's wish to stop.
bool Run::go_on() {
    if (all_stored())
        return end(Outcome::reached_end, stepper_->time(), stepper_->state());
    if (steps_ % options_.segment_steps == 0 && steps_ < options_.max_steps)
        begin_segment();
    if (!options_.stop_requested || !options_.stop_requested())
        return true;
    return end(Outcome::interrupted, stepper_->time(), stepper_->state());
}

bool Run::end(Outcome outcome, double t, State state) {
    solution_.final_time = t;
    solution_.final_state.assign(state.begin(), state.end());
    solution_.status.outcome = outcome;
    solution_.status.reached = t;
    solution_.status.wanted = output_times_.back();
    solution_.status.step = stepper_->time() - stepper_->time_before();
    solution_.status.order = stepper_->order();
    return false;
}

bool Run::fail(const StepFailure& failure, double reached, State state) {
    end(Outcome::failed, reached, state);
    describe_failure(failure, *stepper_, calls_, solution_.status);
    return false;
}

void Run::store_outputs(double until) {
    while (!all_stored() && output_times_[solution_.times.size()] <= until) {
        const double t = output_times_[solution_.times.size()];
        solution_.states.push_back(state_at(t));
        solution_.times.push_back(t);
    }
}

std::vector<double> Run::state_at(double t) {
    const State end = stepper_->state();
    std::vector<double> y(end.begin(), end.end());
    if (t < stepper_->time())
        stepper_->interpolate(t, y);
    return y;
}

/// A step that a terminal event cut short ends there.
void Run::report_step(const EventHit* end) {
    if (!options_.on_step)
        return;
    Step step = stepper_->step();
    if (end) {
        step.time = end->time;
        step.state = end->state;
    }
    options_.on_step(step);
}

void Run::begin_segment() {
    stepper_->start(stepper_->time(), stepper_->state());
    if (options_.on_segment)
        options_.on_segment({stepper_->time(), stepper_->state(), solution_.states, statistics()});
}

} // namespace

Solution solve(const OdeProblem& problem, const OdeOptions& options, std::span<const double> output_times) {
    check_problem(problem, options, output_times);
    return Run(problem, options, output_times).execute();
}

} // namespace rodwake::integrate
