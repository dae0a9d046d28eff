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
    HeldWakes(const integrate::OdeProblem& problem, const StateRates& wakes, const StateRates& others,
              const integrate::OdeOptions& options, std::span<const double> times)
        : ode(problem), wakes_(wakes), options_(options), times_(times), now_(ode.initial_state.size()),
          held_(now_.size()) {
        ode.jacobian = nullptr;
        ode.rhs = [this, &others](double, State y, std::span<double> ydot) {
            others(y, ydot);
            for (std::size_t i = 2; i < y.size(); i += 3)
                ydot[i] += held_[i];
        };
        options_.on_segment = nullptr;
        options_.on_step = [this, &options](const integrate::Step& step) {
            short_step = std::max(short_step, step.time - step.time_before);
            if (options.on_step)
                options.on_step(step);
        };
    }

    /// Both halves of a step; false: the run has ended, by an event, a failure or a wish.
    bool advance(double length) {
        const double start = ode.start_time;
        const double end = start + 1.01 * length < times_.back() ? start + length : times_.back();
        const std::vector<double> before = now_; // half a step before the start
        wakes_(ode.initial_state, now_);
        const std::vector<double> at_start = now_;
        held_ = at_start;
        if (!cross(0.5 * (start + end)))
            return false;
        wakes_(ode.initial_state, now_);
        double squares = 0.0;
        for (std::size_t i = 2; i < now_.size(); i += 3) {
            held_[i] = 2.0 * now_[i] - at_start[i];
            const double line = at_start[i] + (at_start[i] - before[i]) * (end - start) / last_length;
            const double difference = (end - start) / 6.0 * (now_[i] - line);
            squares += difference * difference;
        }
        error = last_length == HUGE_VAL ? 0.0 : std::sqrt(squares) / (options_.rtol + options_.atol);
        last_length = end - start;
        return cross(end);
    }

    integrate::OdeProblem ode; ///< starts where the run is
    integrate::Solution solution;
    /// Length of the last long step, infinite at the start of a segment, and its error in units of the
    /// tolerance.
    double last_length = HUGE_VAL, error = 0.0;
    double short_step = 0.0; ///< the longest since the last crossing; 0: none

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
            std::min(short_step > 0.0 ? short_step : start_length(options_), end - ode.start_time);
        options_.max_steps -= part_steps_;
        short_step = 0.0;
        integrate::Solution part = integrate::solve(ode, options_, stops);
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
        ode.start_time = part.final_time;
        ode.initial_state = solution.final_state = std::move(part.final_state);
        return solution.status.termination == Termination::reached_end && end < times_.back();
    }

    const StateRates& wakes_;
    integrate::OdeOptions options_;
    std::span<const double> times_;
    std::vector<double> now_, held_; ///< the last wakes, and those of the right-hand side
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
        const double& time = run.ode.start_time;
        const std::vector<double>& state = run.ode.initial_state;
        for (long n = 1; run.advance(std::min(length, longest(time, state))); ++n) {
            // The length at which the last step's error would have been half the tolerance.
            length = run.last_length * std::clamp(std::cbrt(0.5 / run.error), 0.3, 1.5);
            if (n % steps_of_segment != 0)
                continue;
            // Go on as a run that starts here.
            run.last_length = HUGE_VAL;
            run.short_step = 0.0;
            length = start_length(options);
            if (options.on_segment)
                options.on_segment({time, state, run.solution.states, run.solution.statistics});
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
