#include "event_finder.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace rodwake::integrate {

/// A solve may begin at the root that ended another: the time of that one is known to a few roundings only,
/// and the way back may be slower.
EventFinder::EventFinder(ProblemCalls& calls, double start_time, State start_state)
    : calls_(calls), events_(calls.problem().events), sampler_(calls),
      latest_start_(start_time + 1e3 * std::numeric_limits<double>::epsilon() * std::abs(start_time)),
      values_before_(events_.size()), values_after_(events_.size()), state_(start_state.size()) {
    evaluate(start_time, start_state, values_after_);
}

std::vector<EventHit> EventFinder::in_last_step(Stepper& stepper, std::span<const double> times) {
    hits_.clear();
    if (events_.empty())
        return {};
    values_before_.swap(values_after_);
    evaluate(stepper.time(), stepper.state(), values_after_);
    std::vector<double> look_at = times_to_look_at(stepper.step(), times);
    if (!sampler_.needed() && look_at.empty() && !any_crosses())
        return {};
    last_ = {stepper.time_before(), values_before_, {}};
    const auto look = [&](double t) { return t > last_.time && go_to(point_at(t, stepper), stepper); };
    if (!sampler_.search(stepper, values_before_, values_after_, std::move(look_at), look))
        go_to({stepper.time(), values_after_, {}}, stepper);
    return std::move(hits_);
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

/// Those inside the step.
std::vector<double> EventFinder::times_to_look_at(const Step& step, std::span<const double> times) const {
    std::vector<double> inside;
    const auto add = [&](double t) {
        if (t > step.time_before && t < step.time)
            inside.push_back(t);
    };
    for (std::size_t i = 0; i < events_.size(); ++i)
        if (events_[i].candidate_time)
            if (const std::optional<double> t = calls_.candidate_time(i, step))
                add(*t);
    if (sampler_.needed())
        for (const double t : times) {
            if (t >= step.time) // they increase
                break;
            add(t);
        }
    return inside;
}

EventFinder::Point EventFinder::point_at(double t, Stepper& stepper) {
    Point point{t, std::vector<double>(events_.size()), {}};
    stepper.interpolate(t, state_);
    evaluate(t, state_, point.values);
    return point;
}

/// An event that has changed sign since the last point and has no root there yet.
std::optional<std::size_t> EventFinder::next_crossing(const Point& to) const {
    for (std::size_t i = 0; i < events_.size(); ++i)
        if (crosses(i, last_.values[i], to.values[i]) && std::ranges::count(to.roots, i) == 0)
            return i;
    return std::nullopt;
}

/// From the last point, by way of all roots between.
bool EventFinder::go_to(Point to, Stepper& stepper) {
    const std::size_t most = 100 + 20 * events_.size(); // a smooth event has one between two points
    for (std::size_t roots = 0; const auto event = next_crossing(to); ++roots) {
        if (roots > most)
            throw StepFailure{
                "RTFUNC_FAIL",
                fmt::format("more than {} roots of event '{}' and others near t={}: an event is noisy "
                            "or discontinuous",
                            most, events_[*event].name, to.time)};
        const double t = locate(*event, last_, to, stepper);
        if (t >= to.time) {
            to.roots.push_back(*event);
            continue;
        }
        Point root = point_at(t, stepper);
        root.roots.push_back(*event);
        if (go_to(std::move(root), stepper))
            return true;
    }
    // one found at this point, and then at the root of another event just before it, is there once
    std::erase_if(to.roots, [&](std::size_t i) { return !crosses(i, last_.values[i], to.values[i]); });
    last_ = std::move(to);
    return !last_.roots.empty() && record(last_, stepper);
}

bool EventFinder::record(const Point& root, Stepper& stepper) {
    const State end = stepper.state();
    if (root.time < stepper.time())
        stepper.interpolate(root.time, state_);
    else
        std::copy(end.begin(), end.end(), state_.begin());
    bool terminal = false;
    for (std::size_t i : root.roots) {
        if (events_[i].crossing == Crossing::any && root.time <= latest_start_)
            continue; // the root from which the solve began
        hits_.push_back({i, root.time, state_});
        terminal = terminal || events_[i].terminal;
    }
    return terminal;
}

/// Zero counts as the new sign, so that of a plateau the beginning is found.
double EventFinder::locate(std::size_t event, const Point& from, const Point& to, Stepper& stepper) {
    const double start = from.values[event];
    const auto signed_value = [&](double v) { return v == 0.0 ? -start : v; };
    const auto value = [&](double t) {
        stepper.interpolate(t, state_);
        return signed_value(calls_.event(event, t, state_));
    };
    auto one_rounding = [](double a, double b) {
        return b - a <= 2.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(a), std::abs(b));
    };
    std::uintmax_t iterations = 200;
    return boost::math::tools::toms748_solve(value, from.time, to.time, start, signed_value(to.values[event]),
                                             one_rounding, iterations)
        .second;
}

} // namespace rodwake::integrate
