#pragma once
// When beads in free flight touched the plate that they are in at the end of a step: eight beads at a time,
// with vector instructions chosen at run time. Every target gives the same bits (kernels.hpp).

#include "plates.hpp"

#include <cstddef>

namespace rodwake::granular {

/// Hops shorter than this part of what is left of a step are none.
inline constexpr double shortest_hop = 0.05;

struct Touches {
    static constexpr std::size_t most = 8;

    alignas(64) double z[most], vz[most]; ///< at the end of the step, m, m/s
    alignas(64) double radius[most];      ///< of the beads, m
    /// How long before the end the flight began; then: when it touched, s.
    alignas(64) double back[most];
    alignas(64) double side[most];  ///< of the plate: +1 floor, -1 lid, 0: it is in neither
    alignas(64) double depth[most]; ///< in the plate at the end, m
    alignas(64) double speed[most]; ///< towards the plate at the touch, m/s
};

/// For the first `count` beads. What was in the plate from the start, where another bead pushed it, leaves it
/// by itself: the plate counts as that much lower for it.
void find_touches(const PlateStep& step, std::size_t count, Touches& touches);

} // namespace rodwake::granular
