#pragma once
// States within a step of rods.

#include "rodwake/rods/separation.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
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

// Contact of diffusing rods within a step (noise.hpp), and where their random numbers come from.

/// A place in the halving of a span: node 1 is the span, 2 n and 2 n + 1 are the halves of n.
struct NoisePlace {
    std::uint64_t seed;
    std::uint32_t run, span, node;

    /// What the random bits of a rod are for: the path of a coordinate, or meetings.
    enum class Use : std::uint32_t { x = 1, y = 2, heading = 3, meeting = 4 };
    std::array<std::uint32_t, 4> bits(Use use, std::size_t rod) const;
};

/// A first meeting inside a step.
struct Meeting {
    double share; ///< of the step before it
    std::size_t first, second;
};

/// The earliest meeting at `distance` of rods whose separations diffuse with variance `rate` per time, if one
/// is drawn; rods that are in contact at the step's end have met.
std::optional<Meeting> bridge_contact(const integrate::Step& step, double distance, double rate, Box box,
                                      const NoisePlace& position);

} // namespace rodwake::rods
