#include "first_guess.hpp"

#include "fill_in.hpp"
#include "unwrap.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace rodwake::measure {

namespace {

constexpr double same_heading = 0.1; // rad
constexpr double full_count = 10.0;  // beads at which a bin's coherence begins to be trusted
constexpr std::size_t channels = PhaseRecord::channels;

bool alike(const PhaseBlock& a, const PhaseBlock& b) {
    return a.m == b.m && a.n == b.n &&
           std::abs(std::remainder(a.heading - b.heading, 2.0 * M_PI)) <= same_heading;
}

/// The block to which most frames are alike.
const PhaseBlock& centre_of(const std::vector<PhaseBlock>& blocks) {
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t a = 0; a < blocks.size(); ++a) {
        double frames = 0.0;
        for (const PhaseBlock& b : blocks)
            frames += alike(blocks[a], b) ? b.frames : 0.0;
        if (frames > most) {
            most = frames;
            best = a;
        }
    }
    return blocks[best];
}

/// phase_1 = phase_0 + phase_2 holds up to noise and a whole turn, which is taken out.
Vector2 principal_value(const double* sums, const std::array<Vector2, 3>& g) {
    std::array<double, 3> phase{};
    for (std::size_t k = 0; k < 3; ++k)
        phase[k] = std::atan2(sums[2 * k + 1], sums[2 * k]);
    const double sum = phase[0] + phase[2];
    phase[1] = sum + std::remainder(phase[1] - sum, 2.0 * M_PI);
    BraggPeaks axes;
    axes.G = g;
    return displacement_of(axes, phase);
}

double quality(const double* sums) {
    const double count = sums[PhaseRecord::beads];
    double size = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
        size += std::hypot(sums[2 * k], sums[2 * k + 1]) / 3.0;
    return count > 0.0 ? size / (count + full_count) : 0.0;
}

} // namespace

std::vector<Vector2> first_guess(const std::vector<PhaseBlock>& blocks, const RodGrid& grid,
                                 double far_from) {
    const PhaseBlock& centre = centre_of(blocks);
    std::vector<double> pooled(centre.sums.size(), 0.0);
    for (const PhaseBlock& block : blocks)
        if (alike(centre, block))
            std::ranges::transform(pooled, block.sums, pooled.begin(), std::plus{});
    std::vector<Vector2> u(grid.bins());
    std::vector<double> good(grid.bins());
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        u[j] = principal_value(&pooled[j * channels], centre.g);
        good[j] = quality(&pooled[j * channels]);
    }
    const auto done = unwrap(u, good, grid, LatticeVectors(centre.g), far_from);
    for (double Vector2::*part : {&Vector2::x, &Vector2::y}) {
        std::vector<double> values(u.size());
        std::ranges::transform(u, values.begin(), [&](const Vector2& v) { return v.*part; });
        fill_in(values, done, grid.n);
        for (std::size_t j = 0; j < u.size(); ++j)
            u[j].*part = values[j];
    }
    return u;
}

} // namespace rodwake::measure
