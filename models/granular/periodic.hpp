#pragma once
// Nearest images in the periodic square.

namespace rodwake::granular {

/// x to the nearest whole number, half to even, for |x| < 2^51: adding and taking off 1.5 2^52 leaves no
/// digits behind the point. Inline on every machine, where std::nearbyint is a call.
inline double nearest_whole(double x) {
    constexpr double shift = 6755399441055744.0;
    return (x + shift) - shift;
}

/// A coordinate difference taken to the nearest image.
inline double nearest_image(double difference, double box) {
    return difference - box * nearest_whole(difference * (1.0 / box));
}

} // namespace rodwake::granular
