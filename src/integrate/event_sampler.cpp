#include "event_sampler.hpp"

#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake::integrate {

namespace {

constexpr std::size_t fineness = 4; // points at which the polynomial is looked at, a panel
constexpr int deepest = 16;         // halvings of a step
constexpr double roundoff = std::numeric_limits<double>::epsilon();

int sign_of(double value) { return (value > 0.0) - (value < 0.0); }

double largest(const std::vector<double>& values) {
    double size = 0.0;
    for (const double value : values)
        size = std::max(size, std::abs(value));
    return size;
}

} // namespace

EventSampler::EventSampler(UserFunctions& calls)
    : calls_(calls), state_(calls.problem().initial_state.size()) {
    const std::vector<Event>& events = calls.problem().events;
    for (std::size_t i = 0; i < events.size(); ++i)
        if (events[i].sampled)
            sampled_.push_back(i);
    largest_.resize(sampled_.size());
}

bool EventSampler::search(Stepper& stepper, const std::vector<double>& before,
                          const std::vector<double>& after, std::vector<double> times, const Look& look) {
    constexpr double most_parts = 64.0; // of a step, for the next one
    std::ranges::sort(times, std::greater<>());
    stepper_ = &stepper;
    look_ = &look;
    times_ = std::move(times);
    first_ = before;
    last_ = after;
    parts_ = 0;
    const Subinterval step{stepper.time_before(), stepper.time(), 0};
    if (!needed())
        return report(step, {}, true);

    // Two samples more than a polynomial of that order needs at the least: one of them is a check. From five
    // panels on no two samples are a third of the part apart.
    const std::size_t panels = static_cast<std::size_t>(std::max(stepper.order(), 4)) + 1;
    if (panels != panels_) {
        panels_ = panels;
        gap_ = std::numbers::pi / static_cast<double>(fineness * panels);
        cosines_.resize(2 * fineness * panels);
        for (std::size_t k = 0; k < cosines_.size(); ++k)
            cosines_[k] = std::cos(gap_ * static_cast<double>(k));
    }
    const bool stop = search(step);
    const double share = most_parts / static_cast<double>(std::max(parts_, 1L));
    stepper.limit_next_step(share < 1.0 ? share * (step.to - step.from)
                                        : std::numeric_limits<double>::infinity());
    return stop;
}

/// Left to right; true: look() has seen enough.
bool EventSampler::search(const Subinterval& part) {
    const std::vector<Samples> all = sample(part);
    std::size_t rough = 0;
    while (rough < all.size() && is_settled(rough, all[rough], part))
        ++rough;
    const double middle = part.from + 0.5 * (part.to - part.from);
    const bool divisible =
        part.to - part.from > 1e3 * roundoff * std::max(std::abs(part.from), std::abs(part.to));
    if (rough < all.size() && part.depth < deepest && divisible)
        return search({part.from, middle, part.depth + 1}) || search({middle, part.to, part.depth + 1});

    constexpr long most_rough = 64; // a jump or a kink has one or two, among many that are not
    ++parts_;
    rough_parts_ = std::max(rough_parts_ + (rough < sampled_.size() ? 1 : -1), 0L);
    if (rough_parts_ > most_rough)
        throw StepFailure{
            "RTFUNC_FAIL",
            fmt::format("event '{}' varies faster at t={} than {} parts of the step from {} to {} "
                        "resolve: it is noisy, or needs a shorter max_step",
                        calls_.problem().events[sampled_[rough]].name, part.from, 1 << deepest,
                        stepper_->time_before(), stepper_->time())};
    for (std::size_t k = 0; k < all.size(); ++k)
        first_[sampled_[k]] = all[k].values.back();
    return report(part, all, rough == all.size());
}

double EventSampler::time_of(const Subinterval& part, std::size_t fine) const {
    if (fine == fineness * panels_)
        return part.to;
    return part.from + 0.5 * (1.0 - cosines_[fine]) * (part.to - part.from);
}

double EventSampler::value_at(std::size_t event, double t) {
    stepper_->interpolate(t, state_);
    return calls_.event(event, t, state_);
}

std::vector<EventSampler::Samples> EventSampler::sample(const Subinterval& part) {
    std::vector<Samples> all(sampled_.size());
    for (std::size_t k = 0; k < all.size(); ++k)
        all[k].values.push_back(first_[sampled_[k]]);
    for (std::size_t j = 1; j <= panels_; ++j) {
        const double t = time_of(part, fineness * j);
        const bool at_end = t >= stepper_->time();
        if (!at_end)
            stepper_->interpolate(t, state_);
        for (std::size_t k = 0; k < all.size(); ++k)
            all[k].values.push_back(at_end ? last_[sampled_[k]] : calls_.event(sampled_[k], t, state_));
    }
    for (Samples& samples : all)
        samples.coefficients = coefficients(samples.values);
    return all;
}

/// Of one event, on the solution itself.
EventSampler::Samples EventSampler::sample(std::size_t event, const Subinterval& part) {
    Samples samples;
    for (std::size_t j = 0; j <= panels_; ++j)
        samples.values.push_back(value_at(event, time_of(part, fineness * j)));
    samples.coefficients = coefficients(samples.values);
    return samples;
}

/// Of the Chebyshev polynomials, by a discrete cosine transform.
std::vector<double> EventSampler::coefficients(const std::vector<double>& values) const {
    std::vector<double> c(values.size());
    for (std::size_t k = 0; k <= panels_; ++k) {
        double sum = 0.0;
        for (std::size_t j = 0; j <= panels_; ++j) {
            const double weight = j == 0 || j == panels_ ? 0.5 : 1.0;
            sum += weight * values[j] * cosines_[fineness * j * k % cosines_.size()];
        }
        c[k] = sum * (k == 0 || k == panels_ ? 1.0 : 2.0) / static_cast<double>(panels_);
    }
    return c;
}

/// The polynomial is good enough to show where roots may be, or is far from zero: the less it is good, the
/// farther; the more samples saw no root, the nearer.
bool EventSampler::is_settled(std::size_t k, const Samples& samples, const Subinterval& part) {
    constexpr double small = 1e-3, rounded = 1e-10;
    const std::vector<double>& c = samples.coefficients;
    const double tail = std::abs(c[panels_]) + std::abs(c[panels_ - 1]);
    const double size = largest(samples.values);
    double varying = 0.0;
    for (std::size_t i = 1; i <= panels_; ++i)
        varying += std::abs(c[i]);
    largest_[k] = std::max(largest_[k], size);
    if (tail <= std::max(small * size, rounded * largest_[k]) ||
        std::abs(c[0]) > varying + 10.0 * tail * std::ldexp(1.0, -part.depth))
        return true;
    return part.depth >= 3 && tail <= 16.0 * rounding(k, samples, part);
}

/// By how much the rounding of the state changes an event in which it cancels; 0 if the event is random.
double EventSampler::rounding(std::size_t k, const Samples& samples, const Subinterval& part) try {
    const double t = time_of(part, fineness * (panels_ / 2)), value = samples.values[panels_ / 2];
    stepper_->interpolate(t, state_);
    if (calls_.event(sampled_[k], t, state_) != value)
        return 0.0;
    for (double& y : state_)
        y *= 1.0 + 4.0 * roundoff;
    return std::abs(calls_.event(sampled_[k], t, state_) - value);
} catch (const StepFailure&) {
    return 0.0; // the event is not defined beside the state
}

/// All times of the part to be looked at.
bool EventSampler::report(const Subinterval& part, const std::vector<Samples>& all, bool settled) {
    constexpr long most_looks = 64; // closer ones: a cluster of roots needs some, rounding has no end
    closer_looks_ = most_looks;
    std::vector<double> times;
    for (; !times_.empty() && times_.back() <= part.to; times_.pop_back())
        times.push_back(times_.back());
    for (std::size_t k = 0; k < all.size(); ++k)
        add_times(sampled_[k], part, all[k], settled, times);
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return std::ranges::any_of(
        times, [&](double t) { return t > stepper_->time_before() && t < stepper_->time() && (*look_)(t); });
}

/// Between two fine points the polynomial, whose shortest wave is eight of them long, has one root, or a dip,
/// or is looked at more closely.
void EventSampler::add_times(std::size_t event, const Subinterval& part, const Samples& samples, bool settled,
                             std::vector<double>& times) {
    constexpr double near_zero = 0.01; // of the largest sample; a believed polynomial is off by less

    // The polynomial on the fine points: what is zero but for rounding is zero.
    double size = 0.0;
    for (const double c : samples.coefficients)
        size += std::abs(c);
    std::vector<double> p(fineness * panels_ + 1);
    for (std::size_t i = 0; i < p.size(); ++i) {
        for (std::size_t k = 0; k <= panels_; ++k)
            p[i] += samples.coefficients[k] * cosines_[i * k % cosines_.size()];
        if (std::abs(p[i]) < 32.0 * roundoff * size)
            p[i] = 0.0;
        if (i % fineness == 0)
            p[i] = samples.values[i / fineness];
    }
    const double zero = near_zero * largest(samples.values);
    for (std::size_t i = 0; i + 1 < p.size(); ++i) {
        const int sign = sign_of(p[i]);
        const bool changes = sign != sign_of(p[i + 1]),
                   near = changes || std::min(sign * p[i], sign * p[i + 1]) <= zero;
        const Subinterval gap{time_of(part, i), time_of(part, i + 1),
                              part.depth + 4}; // some 16 times shorter
        if (changes)
            times.insert(times.end(), {gap.from, gap.to});
        if (!settled || (!changes && sign == 0))
            continue;
        const double down = -sign * slope(samples, i), up = sign * slope(samples, i + 1);
        const bool dips = !changes && down > 0.0 && up > 0.0;
        if (!near && !(dips && sign * p[i] - 0.5 * down * down * gap_ / (down + up) <= zero))
            continue;
        // Where it is monotone, its slopes are like the mean slope, or like twice that in the first and the
        // last gap, where it is even in the angle. At three roots together they are three times the mean and
        // more.
        const double usual = i == 0 || i + 2 == p.size() ? 2.0 : 1.0, mean = (p[i + 1] - p[i]) / gap_;
        const auto is_like = [&](double slope) {
            return slope / mean > 0.5 * usual && slope / mean < 1.5 * usual;
        };
        const bool monotone = is_like(slope(samples, i)) && is_like(slope(samples, i + 1));
        if (!monotone && gap.depth <= deepest && --closer_looks_ > 0)
            add_times(event, gap, sample(event, gap), true, times);
        else if (dips)
            add_dip(event, sign, gap, times);
    }
}

/// Of the polynomial by the angle of the cosine. At the ends, where it is 0, that of the time tells the sign,
/// and its part of the first gap the size.
double EventSampler::slope(const Samples& samples, std::size_t i) const {
    const std::size_t turn = cosines_.size(), last = fineness * panels_;
    double slope = 0.0;
    for (std::size_t k = 1; k <= panels_; ++k) {
        const double c = static_cast<double>(k) * samples.coefficients[k];
        if (i == 0 || i == last)
            slope += (i == 0 ? -gap_ : gap_) * static_cast<double>(k) * c * cosines_[k * i % turn];
        else
            slope -= c * cosines_[(k * i + turn - turn / 4) % turn]; // sin x = cos(x - pi/2)
    }
    return slope;
}

/// The time at which the event has left this sign, if there is one.
void EventSampler::add_dip(std::size_t event, int sign, const Subinterval& gap, std::vector<double>& times) {
    std::optional<double> found;
    const auto value = [&](double u) {
        const double t = gap.from + (u - 1.0) * (gap.to - gap.from);
        const double v = found ? 0.0 : sign * value_at(event, t);
        if (!found && v <= 0.0)
            found = t;
        return v;
    };
    std::uintmax_t iterations = 40;
    boost::math::tools::brent_find_minima(value, 1.0, 2.0, std::numeric_limits<double>::digits / 2,
                                          iterations);
    if (found)
        times.push_back(*found);
}

/// A solve may begin at the root that ended another: the time of that one is known to a few roundings only,
/// and the way back may be slower.
EventFinder::EventFinder(UserFunctions& calls, double start_time, State start_state)
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

    // The times inside the step at which events may change, or at which they are to be looked at.
    const Step step = stepper.step();
    std::vector<double> look_at;
    bool changes = false;
    for (std::size_t i = 0; i < events_.size(); ++i) {
        changes = changes || crosses(i, values_before_[i], values_after_[i]);
        if (events_[i].candidate_time)
            if (const std::optional<double> t = calls_.candidate_time(i, step))
                look_at.push_back(*t);
    }
    if (sampler_.needed())
        look_at.insert(look_at.end(), times.begin(),
                       std::ranges::lower_bound(times, step.time)); // they increase
    std::erase_if(look_at, [&](double t) { return !(t > step.time_before && t < step.time); });
    if (!sampler_.needed() && look_at.empty() && !changes)
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

EventFinder::EventPoint EventFinder::point_at(double t, Stepper& stepper) {
    EventPoint point{t, std::vector<double>(events_.size()), {}};
    stepper.interpolate(t, state_);
    evaluate(t, state_, point.values);
    return point;
}

/// From the last point, by way of all roots between.
bool EventFinder::go_to(EventPoint to, Stepper& stepper) {
    // An event that has changed sign since the last point and has no root there yet.
    const auto next_crossing = [&]() -> std::optional<std::size_t> {
        for (std::size_t i = 0; i < events_.size(); ++i)
            if (crosses(i, last_.values[i], to.values[i]) && std::ranges::count(to.roots, i) == 0)
                return i;
        return std::nullopt;
    };
    const std::size_t most = 100 + 20 * events_.size(); // a smooth event has one between two points
    for (std::size_t roots = 0; const auto event = next_crossing(); ++roots) {
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
        EventPoint root = point_at(t, stepper);
        root.roots.push_back(*event);
        if (go_to(std::move(root), stepper))
            return true;
    }
    // one found at this point, and then at the root of another event just before it, is there once
    std::erase_if(to.roots, [&](std::size_t i) { return !crosses(i, last_.values[i], to.values[i]); });
    last_ = std::move(to);
    if (last_.roots.empty())
        return false;

    // Record the roots at this point, but for the root from which the solve began.
    const State end = stepper.state();
    if (last_.time < stepper.time())
        stepper.interpolate(last_.time, state_);
    else
        std::copy(end.begin(), end.end(), state_.begin());
    bool terminal = false;
    for (const std::size_t i : last_.roots) {
        if (events_[i].crossing == Crossing::any && last_.time <= latest_start_)
            continue;
        hits_.push_back({i, last_.time, state_});
        terminal = terminal || events_[i].terminal;
    }
    return terminal;
}

/// Zero counts as the new sign, so that of a plateau the beginning is found.
double EventFinder::locate(std::size_t event, const EventPoint& from, const EventPoint& to,
                           Stepper& stepper) {
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
