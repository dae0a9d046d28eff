#pragma once
// Contact of diffusing rods within a step (noise.hpp), and where their random numbers come from.

#include "rodwake/rods/separation.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace rodwake::rods {

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
                                      const NoisePlace& place);

} // namespace rodwake::rods
