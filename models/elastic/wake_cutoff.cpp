#include "wake_cutoff.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace rodwake::elastic {

namespace {

// Distances in steps of an eighth of a binade, found from the bits; the bound falls with the distance, so it
// holds all over a step if it holds at its beginning.
constexpr int step_bits = 49;
constexpr double nearest = 0x1p-100, farthest = 0x1p100;

std::size_t step_of(double distance) {
    return (std::bit_cast<std::uint64_t>(distance) >> step_bits) -
           (std::bit_cast<std::uint64_t>(nearest) >> step_bits);
}

double beginning(std::size_t step) {
    return std::bit_cast<double>((step + (std::bit_cast<std::uint64_t>(nearest) >> step_bits)) << step_bits);
}

/// Least r + x from which on the field is below the cutoff at this distance: by bisection, from above. It is
/// 2 r at most, ahead; infinite if the field there is too large.
double least_ahead(const WakeBound& bound, const Cutoff& cutoff, double distance) {
    const auto below = [&](double ahead) {
        return bound.strain(distance, ahead) <= cutoff.strain &&
               (!cutoff.with_polar || bound.polar(distance, ahead) <= cutoff.polar);
    };
    double low = 0.0, high = 4.0 * distance;
    if (below(low))
        return low;
    if (!below(high))
        return std::numeric_limits<double>::infinity();
    for (int k = 0; k < 20; ++k) {
        const double middle = 0.5 * (low + high);
        (below(middle) ? high : low) = middle;
    }
    return high;
}

} // namespace

WakeCutoff::WakeCutoff(const Medium& medium, const Cutoff& cutoff) : inverse_xi_(1.0 / medium.xi) {
    const WakeBound bound(medium);
    const std::size_t steps = step_of(farthest);
    for (std::size_t k = 0; k < steps; ++k) {
        const bool all = !least_.empty() && least_.back() == 0.0; // and so farther out
        least_.push_back(all ? 0.0 : least_ahead(bound, cutoff, beginning(k) * medium.xi) * inverse_xi_);
    }
}

bool WakeCutoff::skips(const KernelSource& source, const Circle& circle) const {
    constexpr double round_off = 1e-12;
    const double dx = circle.x - source.x, dy = circle.y - source.y, r = std::sqrt(dx * dx + dy * dy);
    const double distance = (r * (1.0 - round_off) - circle.radius) * inverse_xi_;
    if (!(distance > nearest && distance < farthest))
        return false;
    // r + x is convex: nowhere below its tangent plane, whose slope is sqrt(2 (1 + x/r))
    const double ahead = r + dx * source.cosine + dy * source.sine,
                 slope = std::sqrt(2.0 * std::max(ahead, 0.0) / r);
    return (ahead - circle.radius * slope - round_off * r) * inverse_xi_ >= least_[step_of(distance)];
}

} // namespace rodwake::elastic
