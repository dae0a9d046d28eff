#pragma once
// The track of a rod, as the measures of its heading and of its speed take it.

#include <vector>

namespace rodwake::measure {

/// Of one run: evenly spaced times, s (a last one that is not is left out); place, m; heading without jumps,
/// rad. All of one length.
struct HeadingTrack {
    std::vector<double> time, x, y, heading;
};

} // namespace rodwake::measure
