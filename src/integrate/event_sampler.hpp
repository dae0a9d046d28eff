#pragma once
// Where inside a step the roots of events may hide that its ends do not show.
//
// A part of the step is sampled at Chebyshev points, more than the order of the method. The polynomial
// through the samples is believed if its last coefficients are small; else the part is halved. Of the
// polynomial each change of sign is reported, and each minimum near zero that turns out to reach it.

#include "stepper.hpp"

#include <functional>
#include <vector>

namespace rodwake::integrate {

class EventSampler {
public:
    explicit EventSampler(UserFunctions& calls);

    bool needed() const { return !sampled_.empty(); }

    /// Calls look(t) in order of time at all `times` and at times that separate the roots, until it returns
    /// true, which it returns; all are inside the last step. `before` and `after`: the values of all events
    /// at its ends. Asks the stepper for shorter steps where events vary much faster. Throws StepFailure.
    using Look = std::function<bool(double)>;
    bool search(Stepper& stepper, const std::vector<double>& before, const std::vector<double>& after,
                std::vector<double> times, const Look& look);

private:
    /// The samples of one event in one part of the step, and the polynomial through them.
    struct Samples {
        std::vector<double> values, coefficients;
    };
    struct Subinterval {
        double from, to;
        int depth;
    };

    double time_of(const Subinterval& part, std::size_t fine) const;
    double value_at(std::size_t event, double t);
    std::vector<Samples> sample(const Subinterval& part);
    Samples sample(std::size_t event, const Subinterval& part);
    std::vector<double> coefficients(const std::vector<double>& values) const;
    bool is_settled(std::size_t k, const Samples& samples, const Subinterval& part);
    double rounding(std::size_t k, const Samples& samples, const Subinterval& part);
    bool search(const Subinterval& part);
    bool report(const Subinterval& part, const std::vector<Samples>& all, bool settled);
    void add_times(std::size_t event, const Subinterval& part, const Samples& samples, bool settled,
                   std::vector<double>& times);
    double slope(const Samples& samples, std::size_t i) const;
    void add_dip(std::size_t event, int sign, const Subinterval& gap, std::vector<double>& times);

    UserFunctions& calls_;
    std::vector<std::size_t> sampled_; ///< the events
    std::vector<double> largest_;      ///< |value| of each so far
    std::size_t panels_ = 0;           ///< one less than the samples of a part
    double gap_ = 0.0;                 ///< angle from a fine point to the next, pi/(4 panels)
    std::vector<double> cosines_;      ///< of its multiples, one turn
    std::vector<double> state_;        ///< scratch

    // of the search under way
    Stepper* stepper_ = nullptr;
    const Look* look_ = nullptr;
    std::vector<double> first_, last_; ///< the values where the next part begins, and at the end of the step
    std::vector<double> times_;        ///< those still to be looked at, the next one last
    long parts_ = 0, rough_parts_ = 0; ///< rough: less those that were not
    long closer_looks_ = 0;            ///< left for this part
};

// Finds the roots of all events inside one step.
//
// All events are compared from point to point: at the times at which roots may hide (event_sampler.hpp), at
// those that events or the user name, and at the end of the step. Each change of sign is located by
// bracketing on the solution inside the step, and every root found becomes a point at which all events are
// compared.

class EventFinder {
public:
    EventFinder(UserFunctions& calls, double start_time, State start_state);

    /// Roots in (time_before, time] of the stepper's last step, in order of time and not beyond the first
    /// terminal one. The time of a root is the later end of its bracket, one rounding wide: the event has
    /// changed sign there. Sampled events are looked at at `times` too. Throws StepFailure.
    std::vector<EventHit> in_last_step(Stepper& stepper, std::span<const double> times);

private:
    struct EventPoint {
        double time;
        std::vector<double> values;
        std::vector<std::size_t> roots; ///< events whose root is at this time
    };

    void evaluate(double t, State y, std::vector<double>& values);
    bool crosses(std::size_t event, double from, double to) const;
    EventPoint point_at(double t, Stepper& stepper);
    // True: a terminal event ends the solve there.
    bool go_to(EventPoint to, Stepper& stepper);
    double locate(std::size_t event, const EventPoint& from, const EventPoint& to, Stepper& stepper);

    UserFunctions& calls_;
    const std::vector<Event>& events_;
    EventSampler sampler_;
    double latest_start_; ///< later than the start by roundings
    std::vector<double> values_before_, values_after_;
    EventPoint last_{};          ///< up to which the step has been looked at
    std::vector<EventHit> hits_; ///< of this step
    std::vector<double> state_;  ///< scratch
};

} // namespace rodwake::integrate
