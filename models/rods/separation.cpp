#include "rodwake/rods/separation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::rods {

namespace {

using integrate::State;

double square_distance(State y, std::size_t a, std::size_t b) {
    const double dx = y[3 * a] - y[3 * b], dy = y[3 * a + 1] - y[3 * b + 1];
    return dx * dx + dy * dy;
}

/// d(r^2)/dt
double square_rate(State y, std::size_t a, std::size_t b) {
    const double dx = y[3 * a] - y[3 * b], dy = y[3 * a + 1] - y[3 * b + 1];
    const double ta = y[3 * a + 2], tb = y[3 * b + 2];
    return 2.0 * (dx * (std::cos(ta) - std::cos(tb)) + dy * (std::sin(ta) - std::sin(tb)));
}

/// Cubic on [0, 1] with end values f0, f1 and end slopes g0 < 0 < g1.
struct Hermite {
    double f0, f1, g0, g1;

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

std::optional<Approach> approach_of_pair(const integrate::Step& step, std::size_t a, std::size_t b) {
    const double h = step.time - step.time_before;
    const double g0 = h * square_rate(step.state_before, a, b), g1 = h * square_rate(step.state, a, b);
    if (!(g0 < 0.0 && g1 > 0.0))
        return std::nullopt;
    const Hermite curve{square_distance(step.state_before, a, b), square_distance(step.state, a, b), g0, g1};
    const double u = curve.minimum_at();
    return Approach{step.time_before + u * h, {a, b, std::sqrt(std::max(0.0, curve.at(u)))}};
}

} // namespace

Separation closest_pair(State y) {
    const std::size_t rods = y.size() / 3;
    Separation best{0, 1, square_distance(y, 0, 1)};
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = a + 1; b < rods; ++b)
            if (const double square = square_distance(y, a, b); square < best.distance)
                best = {a, b, square};
    best.distance = std::sqrt(best.distance);
    return best;
}

double separation_rate(State y, std::size_t a, std::size_t b) {
    return 0.5 * square_rate(y, a, b) / std::sqrt(square_distance(y, a, b));
}

double encounter_step(State y) {
    const std::size_t rods = y.size() / 3;
    double limit = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = a + 1; b < rods; ++b) {
            const double relative_speed = 2.0 * std::abs(std::sin(0.5 * (y[3 * a + 2] - y[3 * b + 2])));
            limit =
                std::min(limit, std::sqrt(square_distance(y, a, b)) / (3.0 * std::max(relative_speed, 0.5)));
        }
    return limit;
}

std::optional<Approach> closest_approach(const integrate::Step& step) {
    const std::size_t rods = step.state.size() / 3;
    std::optional<Approach> best;
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = a + 1; b < rods; ++b)
            if (const auto approach = approach_of_pair(step, a, b))
                if (!best || approach->pair.distance < best->pair.distance)
                    best = approach;
    return best;
}

} // namespace rodwake::rods
