#include "rodwake/rods/separation.hpp"

#include "rodwake/core/periodic.hpp"

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

/// Of one image of b, `shift` away from b itself.
std::optional<Approach> approach_of_image(const integrate::Step& step, std::size_t a, std::size_t b,
                                          Offset shift) {
    const double h = step.time - step.time_before;
    const Offset before = plane_offset(step.state_before, a, b), after = plane_offset(step.state, a, b);
    const Offset d0{before.x - shift.x, before.y - shift.y}, d1{after.x - shift.x, after.y - shift.y};
    const double g0 = h * square_rate(step.state_before, a, b, d0),
                 g1 = h * square_rate(step.state, a, b, d1);
    if (!(g0 < 0.0 && g1 > 0.0))
        return std::nullopt;
    const Hermite curve{square(d0), square(d1), g0, g1};
    const double u = curve.minimum_at();
    return Approach{step.time_before + u * h, {a, b, std::sqrt(std::max(0.0, curve.at(u)))}};
}

/// Where the image of b nearest to a is.
Offset image_shift(State y, std::size_t a, std::size_t b, double box) {
    const Offset d = plane_offset(y, a, b);
    return {nearest_shift(d.x, box), nearest_shift(d.y, box)};
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
    return box ? Offset{nearest_image(d.x, *box), nearest_image(d.y, *box)} : d;
}

Separation closest_pair(State y, Box box) {
    const std::size_t rods = y.size() / 3;
    Separation best{0, 1, square_distance(y, 0, 1, box)};
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = a + 1; b < rods; ++b)
            if (const double found = square_distance(y, a, b, box); found < best.distance)
                best = {a, b, found};
    best.distance = std::sqrt(best.distance);
    return best;
}

double encounter_step(State y, Box box) {
    const std::size_t rods = y.size() / 3;
    double limit = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = a + 1; b < rods; ++b) {
            const double relative_speed = 2.0 * std::abs(std::sin(0.5 * (y[3 * a + 2] - y[3 * b + 2])));
            limit = std::min(limit, std::sqrt(square_distance(y, a, b, box)) /
                                        (3.0 * std::max(relative_speed, 0.5)));
        }
    return limit;
}

std::optional<Approach> closest_approach(const integrate::Step& step, Box box) {
    const std::size_t rods = step.state.size() / 3;
    std::optional<Approach> best;
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = a + 1; b < rods; ++b)
            if (const auto approach = approach_of_pair(step, a, b, box))
                if (!best || approach->pair.distance < best->pair.distance)
                    best = approach;
    return best;
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
