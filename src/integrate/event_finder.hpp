#pragma once
// Finds the roots of all events inside one step.
//
// All events are compared from point to point: at the times at which roots may hide (event_sampler.hpp), at
// those that events or the user name, and at the end of the step. Each change of sign is located by
// bracketing on the solution inside the step, and every root found becomes a point at which all events are
// compared.

#include "event_sampler.hpp"

#include <vector>

namespace rodwake::integrate {

class EventFinder {
public:
    EventFinder(ProblemCalls& calls, double start_time, State start_state);

    /// Roots in (time_before, time] of the stepper's last step, in order of time and not beyond the first
    /// terminal one. The time of a root is the later end of its bracket, one rounding wide: the event has
    /// changed sign there. Sampled events are looked at at `times` too. Throws StepFailure.
    std::vector<EventHit> in_last_step(Stepper& stepper, std::span<const double> times);

private:
    struct Point {
        double time;
        std::vector<double> values;
        std::vector<std::size_t> roots; ///< events whose root is at this time
    };

    void evaluate(double t, State y, std::vector<double>& values);
    bool crosses(std::size_t event, double from, double to) const;
    bool any_crosses() const;
    std::vector<double> times_to_look_at(const Step& step, std::span<const double> times) const;
    Point point_at(double t, Stepper& stepper);
    // True: a terminal event ends the solve there.
    bool go_to(Point to, Stepper& stepper);
    bool record(const Point& root, Stepper& stepper);
    std::optional<std::size_t> next_crossing(const Point& to) const;
    double locate(std::size_t event, const Point& from, const Point& to, Stepper& stepper);

    ProblemCalls& calls_;
    const std::vector<Event>& events_;
    EventSampler sampler_;
    double latest_start_; ///< later than the start by roundings
    std::vector<double> values_before_, values_after_;
    Point last_{};               ///< up to which the step has been looked at
    std::vector<EventHit> hits_; ///< of this step
    std::vector<double> state_;  ///< scratch
};

} // namespace rodwake::integrate
