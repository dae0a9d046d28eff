#pragma once
// How an encounter of two rods ended.

#include "rodwake/measure/pairs.hpp"

namespace rodwake::measure {

/// Place of rod 0 seen from rod 1 in a row of the track, m: at first the nearest image, then without jumps.
struct Apart {
    double x = 0.0, y = 0.0;
};
Apart apart(const PairTrack& track, double box, std::size_t row);

/// Distance of nearest images, m.
double image_distance(const PairTrack& track, double box, std::size_t row);

struct Ending {
    PairOutcome outcome = PairOutcome::escape;
    double time = 0.0;
};
Ending ending(const PairTrack& track, const PairKeys& keys);

} // namespace rodwake::measure
