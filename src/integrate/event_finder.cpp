#include "event_finder.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace rodwake::integrate {

EventFinder::EventFinder(ProblemCalls& calls, double start_time, State start_state)
    : calls_(calls), events_(calls.problem().events), values_before_(events_.size()),
      values_after_(events_.size()), state_(start_state.size()) {
    evaluate(start_time, start_state, values_after_);
}

std::vector<EventHit> EventFinder::in_last_step(Stepper& stepper) {
    if (events_.empty())
        return {};
    values_before_.swap(values_after_);
    evaluate(stepper.time(), stepper.state(), values_after_);
    collect_suspects(stepper.step());
    if (suspects_.empty() && !any_crosses())
        return {};
    return hits_at(points_of_interest(stepper), stepper);
}

void EventFinder::evaluate(double t, State y, std::vector<double>& values) {
    for (std::size_t i = 0; i < events_.size(); ++i)
        values[i] = calls_.event(i, t, y);
}

/// From zero nothing crosses: an event that is zero at the start waits until it has left zero.
bool EventFinder::crosses(std::size_t event, double from, double to) const {
    const bool rises = from < 0.0 && to >= 0.0, falls = from > 0.0 && to <= 0.0;
    switch (events_[event].crossing) {
    case Crossing::rising:
        return rises;
    case Crossing::falling:
        return falls;
    case Crossing::any:
        break;
    }
    return rises || falls;
}

bool EventFinder::any_crosses() const {
    for (std::size_t i = 0; i < events_.size(); ++i)
        if (crosses(i, values_before_[i], values_after_[i]))
            return true;
    return false;
}

void EventFinder::collect_suspects(const Step& step) {
    suspects_.clear();
    for (std::size_t i = 0; i < events_.size(); ++i) {
        if (!events_[i].suspect)
            continue;
        const std::optional<double> t = calls_.suspect(i, step);
        if (t && *t > step.time_before && *t < step.time)
            suspects_.push_back(*t);
    }
    std::sort(suspects_.begin(), suspects_.end());
}

/// The ends of the step, the suspected times, and every root between them.
std::vector<EventFinder::Point> EventFinder::points_of_interest(Stepper& stepper) {
    const std::size_t most =
        100 + 20 * events_.size(); // a smooth event has a few roots a step, noise has no end
    std::vector<Point> points{{stepper.time_before(), values_before_, {}}};
    for (double t : suspects_)
        points.push_back(point_at(t, stepper));
    points.push_back({stepper.time(), values_after_, {}});
    while (split(points, stepper))
        if (points.size() > most)
            throw StepFailure{"RTFUNC_FAIL",
                              fmt::format("more than {} event roots in the step to t={}: an event is "
                                          "noisy or discontinuous",
                                          most, stepper.time())};
    return points;
}

EventFinder::Point EventFinder::point_at(double t, Stepper& stepper) {
    Point point{t, std::vector<double>(events_.size()), {}};
    stepper.interpolate(t, state_);
    evaluate(t, state_, point.values);
    return point;
}

/// Locates one root not yet recorded; false when there is none.
bool EventFinder::split(std::vector<Point>& points, Stepper& stepper) {
    for (std::size_t p = 0; p + 1 < points.size(); ++p) {
        const Point &from = points[p], &to = points[p + 1];
        for (std::size_t i = 0; i < events_.size(); ++i) {
            const bool recorded = std::find(to.roots.begin(), to.roots.end(), i) != to.roots.end();
            if (recorded || !crosses(i, from.values[i], to.values[i]))
                continue;
            record(i, locate(i, from, to, stepper), p, points, stepper);
            return true;
        }
    }
    return false;
}

double EventFinder::locate(std::size_t event, const Point& from, const Point& to, Stepper& stepper) {
    auto value = [&](double t) {
        stepper.interpolate(t, state_);
        return calls_.event(event, t, state_);
    };
    auto one_rounding = [](double a, double b) {
        return b - a <= 2.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(a), std::abs(b));
    };
    std::uintmax_t iterations = 200;
    return boost::math::tools::toms748_solve(value, from.time, to.time, from.values[event], to.values[event],
                                             one_rounding, iterations)
        .second;
}

void EventFinder::record(std::size_t event, double t, std::size_t before, std::vector<Point>& points,
                         Stepper& stepper) {
    Point& next = points[before + 1];
    if (t >= next.time) {
        next.roots.push_back(event);
        return;
    }
    Point root = point_at(t, stepper);
    root.roots.push_back(event);
    points.insert(points.begin() + static_cast<std::ptrdiff_t>(before) + 1, std::move(root));
}

std::vector<EventHit> EventFinder::hits_at(const std::vector<Point>& points, Stepper& stepper) {
    std::vector<EventHit> hits;
    for (const Point& point : points) {
        if (point.roots.empty())
            continue;
        bool terminal = false;
        const State end = stepper.state();
        if (point.time < stepper.time())
            stepper.interpolate(point.time, state_);
        else
            std::copy(end.begin(), end.end(), state_.begin());
        for (std::size_t i : point.roots) {
            hits.push_back({i, point.time, state_});
            terminal = terminal || events_[i].terminal;
        }
        if (terminal)
            break;
    }
    return hits;
}

} // namespace rodwake::integrate
