#pragma once
// The track of a rod, as the measures of its heading and of its speed take it.

#include <cmath>
#include <cstddef>
#include <vector>

namespace rodwake::measure {

/// Of one run: times, s, evenly spaced but for films (a last one that is nearer is left out); place, m;
/// heading without jumps, rad. All of one length. A rod of a film is not known in every row: heading, and
/// perhaps place, are NaN.
struct HeadingTrack {
    std::vector<double> time, x, y, heading;

    bool known(std::size_t row) const { return !std::isnan(heading[row]); }
};

} // namespace rodwake::measure
