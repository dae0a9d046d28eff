#include "rodwake/rods/separation.hpp"

#include "rodwake/core/periodic.hpp"
#include "sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::rods {

namespace {

using integrate::State;

Offset plane_offset(State y, std::size_t a, std::size_t b) {
    return {y[3 * a] - y[3 * b], y[3 * a + 1] - y[3 * b + 1]};
}

double square(Offset d) { return d.x * d.x + d.y * d.y; }

double square_distance(State y, std::size_t a, std::size_t b, Box box) {
    return square(offset(y, a, b, box));
}

/// d(r^2)/dt
double square_rate(State y, std::size_t a, std::size_t b, Offset d) {
    const double ta = y[3 * a + 2], tb = y[3 * b + 2];
    return 2.0 * (d.x * (std::cos(ta) - std::cos(tb)) + d.y * (std::sin(ta) - std::sin(tb)));
}

/// Cubic on [0, 1] with end values f0, f1 and end slopes g0, g1.
struct Hermite {
    double f0, f1, g0, g1;

    /// With g0 < 0 < g1.
    double minimum_at() const {
        const double a = 3.0 * (2.0 * (f0 - f1) + g0 + g1), b = 2.0 * (3.0 * (f1 - f0) - 2.0 * g0 - g1);
        const double root = std::sqrt(std::max(0.0, b * b - 4.0 * a * g0));
        return std::clamp(-2.0 * g0 / (b + root), 0.0, 1.0); // slope a u^2 + b u + g0, its rising zero
    }
    double at(double u) const {
        const double v = 1.0 - u;
        return v * v * ((1.0 + 2.0 * u) * f0 + u * g0) + u * u * ((1.0 + 2.0 * v) * f1 - v * g1);
    }
};

/// The closest distance on the cubic of the offset itself: what its square loses where it is small beside
/// those at the ends.
double distance_of_offsets(const integrate::Step& step, std::size_t a, std::size_t b, Offset d0, Offset d1,
                           double u) {
    const double h = step.time - step.time_before;
    const auto rate = [&](State y, auto part) { return h * (part(y[3 * a + 2]) - part(y[3 * b + 2])); };
    const auto cosine = [](double angle) { return std::cos(angle); };
    const auto sine = [](double angle) { return std::sin(angle); };
    const Hermite x{d0.x, d1.x, rate(step.state_before, cosine), rate(step.state, cosine)},
        y{d0.y, d1.y, rate(step.state_before, sine), rate(step.state, sine)};
    return std::hypot(x.at(u), y.at(u));
}

/// Of one image of b, `shift` away from b itself.
std::optional<Approach> approach_of_image(const integrate::Step& step, std::size_t a, std::size_t b,
                                          Offset shift) {
    constexpr double lost = 1e6 * 8.0 * std::numeric_limits<double>::epsilon(); // six digits left of a square
    const double h = step.time - step.time_before;
    const Offset before = plane_offset(step.state_before, a, b), after = plane_offset(step.state, a, b);
    const Offset d0{before.x - shift.x, before.y - shift.y}, d1{after.x - shift.x, after.y - shift.y};
    const double g0 = h * square_rate(step.state_before, a, b, d0),
                 g1 = h * square_rate(step.state, a, b, d1);
    if (!(g0 < 0.0 && g1 > 0.0))
        return std::nullopt;
    const Hermite curve{square(d0), square(d1), g0, g1};
    const double u = curve.minimum_at(), lowest = curve.at(u);
    const double distance = lowest > lost * std::max(curve.f0, curve.f1)
                                ? std::sqrt(lowest)
                                : distance_of_offsets(step, a, b, d0, d1, u);
    return Approach{step.time_before + u * h, {a, b, distance}};
}

/// Where the image of b nearest to a is.
Offset image_shift(State y, std::size_t a, std::size_t b, const PeriodicBox& box) {
    const Offset d = plane_offset(y, a, b);
    return {nearest_shift(d.x, box.x), nearest_shift(d.y, box.y)};
}

/// Of the images nearest at the step's start and at its end.
std::optional<Approach> approach_of_pair(const integrate::Step& step, std::size_t a, std::size_t b, Box box) {
    if (!box)
        return approach_of_image(step, a, b, {0.0, 0.0});
    const Offset start = image_shift(step.state_before, a, b, *box),
                 end = image_shift(step.state, a, b, *box);
    const auto first = approach_of_image(step, a, b, start);
    if (start.x == end.x && start.y == end.y)
        return first;
    const auto second = approach_of_image(step, a, b, end);
    return !first || (second && second->pair.distance < first->pair.distance) ? second : first;
}

} // namespace

Offset offset(State y, std::size_t a, std::size_t b, Box box) {
    const Offset d = plane_offset(y, a, b);
    return box ? Offset{nearest_image(d.x, box->x), nearest_image(d.y, box->y)} : d;
}

namespace {

bool comes_first(std::size_t a, std::size_t b, const Separation& other) {
    return a < other.first || (a == other.first && b < other.second);
}

/// How far the rod went that went farthest.
double longest_move(const integrate::Step& step) {
    double longest = 0.0;
    for (std::size_t k = 0; k < step.state.size(); k += 3)
        longest = std::max(longest, std::hypot(step.state[k] - step.state_before[k],
                                               step.state[k + 1] - step.state_before[k + 1]));
    return longest;
}

} // namespace

Separation closest_pair(State y, Box box) {
    Separation best{0, 1, square_distance(y, 0, 1, box)};
    Sweep(y, box).pairs([&](double gap) { return gap > 0.0 && gap * gap > best.distance; },
                        [&](std::size_t a, std::size_t b) {
                            const double found = square_distance(y, a, b, box);
                            if (found < best.distance || (found == best.distance && comes_first(a, b, best)))
                                best = {a, b, found};
                        });
    best.distance = std::sqrt(best.distance);
    return best;
}

double passing_resolution(State y, double first, double tolerance) {
    double farthest = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i)
        if (i % 3 != 2)
            farthest = std::max(farthest, std::abs(y[i]));
    constexpr double few_steps = 64.0; // of rounding
    const double rounding = few_steps * std::numeric_limits<double>::epsilon() * farthest;
    return std::min(std::max(tolerance, rounding), 1e-3 * first);
}

// No relative speed is above 2, so a pair farther apart than 3 * 2 times the present limit cannot lower it.
double encounter_step(State y, Box box) {
    constexpr double farthest = 6.0 * (1.0 + 1e-12); // with room for rounding
    double limit = std::numeric_limits<double>::infinity();
    Sweep(y, box).pairs([&](double gap) { return gap > farthest * limit; },
                        [&](std::size_t a, std::size_t b) {
                            const double relative_speed =
                                2.0 * std::abs(std::sin(0.5 * (y[3 * a + 2] - y[3 * b + 2])));
                            limit = std::min(limit, std::sqrt(square_distance(y, a, b, box)) /
                                                        (3.0 * std::max(relative_speed, 0.5)));
                        });
    return limit;
}

// Which pairs need no look. On the cubic of a pair the weights of its end slopes g0, g1 are at most 4/27, and
// |g| <= h d(r^2)/dt <= 4 h r. With m the smaller and M the larger separation at the ends it stays above
//
//   m^2 - (4/27) 4 h (m + M) >= m^2 - (32/27) k (m + k),   k the larger of h and the longest move of a rod,
//
// since M <= m + 2 k. For m >= B + 2 k that is above B^2: 4 B k + 4 k^2 outweigh (32/27) (B k + 3 k^2). So m
// must be below B + 2 k for the pair to come closer than B, and its separation before below B + 4 k: if it is
// not the smaller one it is at most 2 k more. The same holds for an image that is nearest at one end only.
std::optional<Approach> closest_approach(const integrate::Step& step, Box box, double below) {
    const double reach = 4.0 * std::max(step.time - step.time_before, longest_move(step));
    std::optional<Approach> best;
    double bound = below;
    Sweep(step.state_before, box)
        .pairs([&](double gap) { return gap > (bound + reach) * (1.0 + 1e-12); },
               [&](std::size_t a, std::size_t b) {
                   const auto found = approach_of_pair(step, a, b, box);
                   if (!found || !(found->pair.distance < below))
                       return;
                   const double distance = found->pair.distance;
                   if (!best || distance < bound || (distance == bound && comes_first(a, b, best->pair))) {
                       best = found;
                       bound = distance;
                   }
               });
    return best;
}

std::optional<double> first_approach_time(const integrate::Step& step, Box box, double below) {
    const double reach = below + 4.0 * std::max(step.time - step.time_before, longest_move(step));
    std::optional<double> first;
    Sweep(step.state_before, box)
        .pairs([&](double gap) { return gap > reach * (1.0 + 1e-12); },
               [&](std::size_t a, std::size_t b) {
                   const auto found = approach_of_pair(step, a, b, box);
                   if (found && found->pair.distance < below)
                       first = std::min(found->time, first.value_or(found->time));
               });
    return first;
}

double fall_time(const integrate::Step& step, std::size_t a, std::size_t b, double distance) {
    const double h = step.time - step.time_before;
    const Offset d0 = plane_offset(step.state_before, a, b), d1 = plane_offset(step.state, a, b);
    const Hermite curve{square(d0), square(d1), h * square_rate(step.state_before, a, b, d0),
                        h * square_rate(step.state, a, b, d1)};
    double outside = 0.0, inside = 1.0;
    for (int k = 0; k < 53; ++k) {
        const double middle = 0.5 * (outside + inside);
        (curve.at(middle) > distance * distance ? outside : inside) = middle;
    }
    return step.time_before + inside * h;
}

} // namespace rodwake::rods
