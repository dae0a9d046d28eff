#pragma once
// Coordinates in a periodic box of side `box` > 0: differences to the nearest image, places put back into it.
// Three forms of the same difference, because its callers differ in what they know and in what it may cost:
//
//   nearest_image          any difference, exact, [-box/2, box/2]; a call of the library
//   nearest_image_rounded  |difference| < 2^51 box; inline and without branches, off by a rounding of the
//                          difference; the form that the vector loops have (granular/kernels.cpp)
//   nearest_image_once     |difference| <= 3/2 box, as of two places in [0, box); exact where the result is
//                          the difference itself, else one rounding; for inner loops
//
// At half a box the two images are equally near: which one is taken differs between the forms.

#include <cmath>

namespace rodwake {

/// To the nearest whole number, half to even, for |x| < 2^51: adding and taking off 1.5 2^52 leaves no digits
/// behind the point. Inline on every machine, where std::nearbyint is a call.
inline double nearest_whole(double x) {
    constexpr double shift = 6755399441055744.0;
    return (x + shift) - shift;
}

inline double nearest_image(double difference, double box) { return std::remainder(difference, box); }

inline double nearest_image_rounded(double difference, double box) {
    return difference - box * nearest_whole(difference * (1.0 / box));
}

inline double nearest_image_once(double difference, double box) {
    const double half = 0.5 * box;
    return difference > half ? difference - box : difference < -half ? difference + box : difference;
}

/// Whole boxes by which the nearest image is away: difference - nearest_shift is the nearest image, and stays
/// that of the same image while the difference changes. |difference| < 2^51 box.
inline double nearest_shift(double difference, double box) { return box * nearest_whole(difference / box); }

/// Distance in the plane to the nearest image.
inline double nearest_distance(double dx, double dy, double box) {
    return std::hypot(nearest_image(dx, box), nearest_image(dy, box));
}

/// The same place in the box, in [0, box).
inline double into_box(double coordinate, double box) {
    const double inside = coordinate - box * std::floor(coordinate / box);
    return inside < box ? inside : 0.0;
}

} // namespace rodwake
