#pragma once
// When two bodies in free flight touch: the root of the gap between them, which is known to lie between a
// time at which they are apart and one at which one is within the other. Newton's step where it stays between
// the two, their middle where it does not, so that a gap that curves the wrong way cannot lead it astray.

#include <algorithm>
#include <cmath>

namespace rodwake::granular {

/// Root of gap(time) between `apart`, where gap > 0, and `within`, where gap <= 0; either may be the earlier.
/// slope(time) = d gap/dt. Stops when a step is no longer than `tolerance`: Newton doubles the digits with
/// each, so the error is about tolerance^2 gap''/(2 slope), then rounding.
template<class Gap, class Slope>
double touch_time(const Gap& gap, const Slope& slope, double apart, double within, double start,
                  double tolerance) {
    double time = start;
    for (int i = 0; i < 60; ++i) { // halving alone gives all digits in 53
        const double here = gap(time);
        (here > 0.0 ? apart : within) = time;
        const auto [low, high] = std::minmax(apart, within);
        const double newton = time - here / slope(time);
        const double next = newton >= low && newton <= high ? newton : (apart + within) / 2.0;
        if (std::abs(next - time) <= tolerance)
            return next;
        time = next;
    }
    return time;
}

} // namespace rodwake::granular
