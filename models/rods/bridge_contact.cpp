#include "bridge_contact.hpp"

#include "rodwake/core/rng.hpp"
#include "rodwake/integrate/additive_noise.hpp"
#include "sweep.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::rods {

namespace {

using Words = std::array<std::uint32_t, 4>;

/// A pair's own bits, from those of its first rod.
Words bits_of_pair(const Words& first, std::size_t second, std::uint32_t draw) {
    return philox_block({static_cast<std::uint32_t>(second), draw, first[2], first[3]}, {first[0], first[1]});
}

/// Inverse Gaussian, by Michael, Schucany and Haas, Am. Stat. 30, 88 (1976); the smaller root without
/// cancellation.
double inverse_gaussian(double mean, double shape, double normal, double uniform) {
    const double a = 0.5 * mean * normal * normal / shape;
    const double root = mean / (1.0 + a + std::sqrt(a * (2.0 + a)));
    return uniform * (mean + root) <= mean ? root : mean * (mean / root);
}

/// When a pair that is d0 > 0 and d1 short of contact at the ends of a step of variance `spread` met first,
/// as a share of the step; given that it did.
double meeting_share(double d0, double d1, double spread, const Words& bits, double uniform) {
    const double end = std::max(std::abs(d1), 1e-9 * d0);
    const double odds = inverse_gaussian(d0 / end, d0 * d0 / spread, integrate::normals_of(bits)[0], uniform);
    return odds / (1.0 + odds);
}

double separation(integrate::State y, std::size_t a, std::size_t b, Box box) {
    const Offset d = offset(y, a, b, box);
    return std::hypot(d.x, d.y);
}

/// How far two rods may come nearer at most.
double closing(const integrate::Step& step) {
    double longest = 0.0;
    for (std::size_t k = 0; k < step.state.size(); k += 3)
        longest = std::max(longest, std::hypot(step.state[k] - step.state_before[k],
                                               step.state[k + 1] - step.state_before[k + 1]));
    return 2.0 * longest;
}

} // namespace

Words NoisePlace::bits(Use use, std::size_t rod) const {
    return philox_block(
        {node, (span << 8) | static_cast<std::uint32_t>(use), run, static_cast<std::uint32_t>(rod)},
        {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
}

std::optional<Meeting> bridge_contact(const integrate::Step& step, double distance, double rate, Box box,
                                      const NoisePlace& place) {
    const double spread = rate * (step.time - step.time_before);
    // Farther apart than this, a pair has met with a probability below exp(-36).
    const double reach = distance + closing(step) + std::sqrt(18.0 * spread);
    std::optional<Meeting> first;
    const auto see = [&](std::size_t a, std::size_t b) {
        const double d0 = separation(step.state_before, a, b, box) - distance;
        if (d0 > reach - distance)
            return;
        const double d1 = separation(step.state, a, b, box) - distance;
        const Words of_rod = place.bits(NoisePlace::Use::meeting, a), bits = bits_of_pair(of_rod, b, 0);
        if (d1 > 0.0 && integrate::uniform_of(bits[0], bits[1]) >= std::exp(-2.0 * d0 * d1 / spread))
            return;
        const double share = meeting_share(d0, d1, spread, bits_of_pair(of_rod, b, 1),
                                           integrate::uniform_of(bits[2], bits[3]));
        if (!first || share < first->share || (share == first->share && a < first->first))
            first = {share, a, b};
    };
    Sweep(step.state_before, box).pairs([&](double gap) { return gap > reach; }, see);
    return first;
}

} // namespace rodwake::rods
