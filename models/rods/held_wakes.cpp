#include "held_wakes.hpp"

#include "rodwake/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace rodwake::rods {

namespace {

using integrate::State;
using integrate::Termination;

/// f/(mu v0), of the first step of a segment, of which there is no estimate: as errors of third order go.
double start_length(const integrate::OdeOptions& options) { return 0.2 * std::cbrt(options.rtol); }

/// Long steps from a state on, with what they have given so far.
class HeldWakes {
public:
    HeldWakes(const integrate::OdeProblem& ode, const StateRates& wakes, const StateRates& others,
              const integrate::OdeOptions& options, std::span<const double> times)
        : ode_(ode), wakes_(wakes), options_(options), times_(times), now_(ode.initial_state.size()),
          held_(now_.size()) {
        ode_.jacobian = nullptr;
        ode_.rhs = [this, &others](double, State y, std::span<double> ydot) {
            others(y, ydot);
            for (std::size_t i = 2; i < y.size(); i += 3)
                ydot[i] += held_[i];
        };
        options_.on_segment = nullptr;
        options_.on_step = [this, &options](const integrate::Step& step) {
            short_step_ = std::max(short_step_, step.time - step.time_before);
            if (options.on_step)
                options.on_step(step);
        };
    }

    /// Both halves of a step; false: the run has ended, by an event, a failure or a wish.
    bool advance(double length) {
        const double start = ode_.start_time;
        const double end = start + 1.01 * length < times_.back() ? start + length : times_.back();
        const std::vector<double> before = now_; // half a step before the start
        wakes_(ode_.initial_state, now_);
        const std::vector<double> at_start = now_;
        held_ = at_start;
        if (!cross(0.5 * (start + end)))
            return false;
        wakes_(ode_.initial_state, now_);
        double squares = 0.0;
        for (std::size_t i = 2; i < now_.size(); i += 3) {
            held_[i] = 2.0 * now_[i] - at_start[i];
            const double line = at_start[i] + (at_start[i] - before[i]) * (end - start) / last_length_;
            const double error = (end - start) / 6.0 * (now_[i] - line);
            squares += error * error;
        }
        error_ = last_length_ == HUGE_VAL ? 0.0 : std::sqrt(squares) / (options_.rtol + options_.atol);
        last_length_ = end - start;
        return cross(end);
    }

    /// The length at which the last step's error would have been half the tolerance.
    double suggested() const { return last_length_ * std::clamp(std::cbrt(0.5 / error_), 0.3, 1.5); }

    /// Goes on as a run that starts here.
    void begin_segment() {
        last_length_ = HUGE_VAL;
        short_step_ = 0.0;
    }
    double time() const { return ode_.start_time; }
    State state() const { return ode_.initial_state; }

    integrate::Solution solution;

private:
    /// The short steps to a time.
    bool cross(double end) {
        std::vector<double> stops;
        for (std::size_t k = solution.times.size(); k < times_.size() && times_[k] <= end; ++k)
            stops.push_back(times_[k]);
        const bool asked = !stops.empty() && stops.back() == end;
        if (!asked)
            stops.push_back(end);
        options_.initial_step =
            std::min(short_step_ > 0.0 ? short_step_ : start_length(options_), end - ode_.start_time);
        options_.max_steps -= part_steps_;
        short_step_ = 0.0;
        integrate::Solution part = integrate::solve(ode_, options_, stops);
        part_steps_ = part.statistics.steps;
        if (!asked && part.times.size() == stops.size()) {
            part.times.pop_back();
            part.states.pop_back();
        }
        std::ranges::move(part.times, std::back_inserter(solution.times));
        std::ranges::move(part.states, std::back_inserter(solution.states));
        std::ranges::move(part.hits, std::back_inserter(solution.hits));
        solution.statistics += part.statistics;
        solution.status = std::move(part.status);
        solution.status.wanted = times_.back();
        solution.final_time = part.final_time;
        ode_.start_time = part.final_time;
        ode_.initial_state = solution.final_state = std::move(part.final_state);
        return solution.status.termination == Termination::reached_end && end < times_.back();
    }

    integrate::OdeProblem ode_;
    const StateRates& wakes_;
    integrate::OdeOptions options_;
    std::span<const double> times_;
    std::vector<double> now_, held_; ///< the last wakes, and those of the right-hand side
    double last_length_ = HUGE_VAL, error_ = 0.0, short_step_ = 0.0;
    long part_steps_ = 0;
};

} // namespace

integrate::Solution solve_with_held_wakes(const integrate::OdeProblem& ode, const StateRates& wakes,
                                          const StateRates& others,
                                          const std::function<double(double, State)>& longest,
                                          const integrate::OdeOptions& options,
                                          std::span<const double> times) {
    constexpr long steps_of_segment = 50;
    HeldWakes run(ode, wakes, others, options, times);
    double length = start_length(options);
    try {
        for (long n = 1; run.advance(std::min(length, longest(run.time(), run.state()))); ++n) {
            length = run.suggested();
            if (n % steps_of_segment != 0)
                continue;
            run.begin_segment();
            length = start_length(options);
            if (options.on_segment)
                options.on_segment({run.time(), run.state(), run.solution.states, run.solution.statistics});
        }
    } catch (const InputError& error) { // two rods in one place
        integrate::Status& status = run.solution.status;
        status.termination = Termination::failed;
        status.flag = "RHSFUNC_FAIL";
        status.cause = error.what();
    }
    return std::move(run.solution);
}

} // namespace rodwake::rods
