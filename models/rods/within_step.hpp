#pragma once
// States within a step of rods.

#include "rodwake/rods/separation.hpp"

#include <cmath>
#include <span>
#include <vector>

namespace rodwake::rods {

/// The state at a time inside a step, on the cubic through its ends and their rates.
inline std::vector<double> state_at(double time, const integrate::Step& step, integrate::State rate_before,
                                    integrate::State rate) {
    const double h = step.time - step.time_before, u = (time - step.time_before) / h, v = 1.0 - u;
    std::vector<double> y(step.state.size());
    for (std::size_t i = 0; i < y.size(); ++i)
        y[i] = v * v * ((1.0 + 2.0 * u) * step.state_before[i] + u * h * rate_before[i]) +
               u * u * ((1.0 + 2.0 * v) * step.state[i] - v * h * rate[i]);
    return y;
}

/// Puts a pair at its distance, along its line: of states that were taken between those of a step.
inline void put_apart(std::span<double> y, const Separation& pair, Box box) {
    const Offset d = offset(y, pair.first, pair.second, box);
    const double r = std::hypot(d.x, d.y), move = r > 0.0 ? 0.5 * (pair.distance / r - 1.0) : 0.0;
    y[3 * pair.first] += move * d.x;
    y[3 * pair.first + 1] += move * d.y;
    y[3 * pair.second] -= move * d.x;
    y[3 * pair.second + 1] -= move * d.y;
}

} // namespace rodwake::rods
