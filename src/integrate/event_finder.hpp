#pragma once
// Finds the roots of all events inside one step.
//
// Each event is compared at the ends of the step, each sign change is located by bracketing on the solution
// inside the step, and every root found becomes a point at which all events are compared again. So an event
// that crosses and returns within the step (a dip below zero) is found whenever another event's root lies
// inside the dip.

#include "stepper.hpp"

#include <vector>

namespace rodwake::integrate {

class EventFinder {
public:
    EventFinder(ProblemCalls& calls, double start_time, State start_state);

    /// Roots in (time_before, time] of the stepper's last step, in order of time and not beyond the first
    /// terminal one. The time of a root is the later end of its bracket, one rounding wide: the event has
    /// changed sign there. Throws StepFailure.
    std::vector<EventHit> in_last_step(Stepper& stepper);

private:
    struct Point {
        double time;
        std::vector<double> values;
        std::vector<std::size_t> roots; ///< events whose root is at this time
    };

    void evaluate(double t, State y, std::vector<double>& values);
    bool crosses(std::size_t event, double from, double to) const;
    bool any_crosses() const;
    /// Times inside the step at which an event asks to be looked at, into suspects_.
    void collect_suspects(const Step& step);
    std::vector<Point> points_of_interest(Stepper& stepper);
    Point point_at(double t, Stepper& stepper);
    bool split(std::vector<Point>& points, Stepper& stepper);
    double locate(std::size_t event, const Point& from, const Point& to, Stepper& stepper);
    void record(std::size_t event, double t, std::size_t before, std::vector<Point>& points,
                Stepper& stepper);
    std::vector<EventHit> hits_at(const std::vector<Point>& points, Stepper& stepper);

    ProblemCalls& calls_;
    const std::vector<Event>& events_;
    std::vector<double> values_before_, values_after_;
    std::vector<double> suspects_;
    std::vector<double> state_; ///< scratch
};

} // namespace rodwake::integrate
