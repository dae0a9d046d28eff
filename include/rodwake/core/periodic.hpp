#pragma once
// The periodic box, and coordinates in it: differences to the nearest image along a side `box` > 0, places
// put back into it.
// Three forms of the same difference, because its callers differ in what they know and in what it may cost:
//
//   nearest_image          any difference, exact, [-box/2, box/2]; a call of the library
//   nearest_image_rounded  |difference| < 2^51 box; inline and without branches, off by a rounding of the
//                          difference; the form that the vector loops have (granular/kernels.cpp)
//   nearest_image_once     |difference| <= 3/2 box, as of two places in [0, box); exact where the result is
//                          the difference itself, else one rounding; for inner loops
//
// At half a box the two images are equally near: which one is taken differs between the forms.

#include <algorithm>
#include <cmath>

namespace rodwake {

/// The periodic rectangle [0, x) x [0, y); sides along the axes, any unit of length. A single number is the
/// side of a square.
struct PeriodicBox {
    double x = 0.0, y = 0.0;

    constexpr PeriodicBox() = default;
    constexpr PeriodicBox(double side) : x(side), y(side) {} // NOLINT(google-explicit-constructor)
    constexpr PeriodicBox(double side_x, double side_y) : x(side_x), y(side_y) {}

    constexpr double area() const { return x * y; }
    constexpr double shorter() const { return std::min(x, y); }
    constexpr double longer() const { return std::max(x, y); }
    constexpr bool square() const { return x == y; }
    /// Side of the square of the same area; that of a square is its side to the last bit.
    double mean_side() const { return std::sqrt(area()); }
    bool operator==(const PeriodicBox&) const = default;
};

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
inline double nearest_distance(double dx, double dy, const PeriodicBox& box) {
    return std::hypot(nearest_image(dx, box.x), nearest_image(dy, box.y));
}

/// The same place in the box, in [0, box).
inline double into_box(double coordinate, double box) {
    const double inside = coordinate - box * std::floor(coordinate / box);
    return inside < box ? inside : 0.0;
}

} // namespace rodwake
