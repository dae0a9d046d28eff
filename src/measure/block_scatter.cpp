#include "block_scatter.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr double borrowed_blocks = 4.0;

double variance(double squares, double blocks) {
    return blocks > 1.0 ? squares * blocks / (blocks - 1.0) : 0.0;
}

double mixed(double squares, double blocks, double typical) {
    const double free = std::max(blocks - 1.0, 0.0);
    return std::sqrt((free * variance(squares, blocks) + borrowed_blocks * typical) /
                     (free + borrowed_blocks));
}

} // namespace

void BlockScatter::add(std::size_t bin, std::span<const Vector2> pulls, const std::vector<bool>& present,
                       const std::vector<bool>& successive) {
    for (std::size_t b = 0; b < pulls.size(); ++b) {
        if (!present[b])
            continue;
        const double xx = pulls[b].x * pulls[b].x, yy = pulls[b].y * pulls[b].y;
        squares_[bin].x += xx;
        squares_[bin].y += yy;
        blocks_[bin] += 1.0;
        if (b == 0 || !successive[b] || !present[b - 1])
            continue;
        const Vector2& last = pulls[b - 1];
        products_ += pulls[b].x * last.x + pulls[b].y * last.y;
        product_squares_ += 0.5 * (xx + yy + last.x * last.x + last.y * last.y);
    }
}

/// s^2: mean of error^2 times count over the bins.
Vector2 BlockScatter::typical(const BinSamples& samples) const {
    Vector2 sum;
    double weight = 0.0;
    for (std::size_t j = 0; j < squares_.size(); ++j) {
        const double free = std::max(blocks_[j] - 1.0, 0.0);
        sum.x += free * variance(squares_[j].x, blocks_[j]) * samples.count[j];
        sum.y += free * variance(squares_[j].y, blocks_[j]) * samples.count[j];
        weight += free;
    }
    return weight > 0.0 ? Vector2{sum.x / weight, sum.y / weight} : Vector2{};
}

void BlockScatter::finish(BinSamples& samples) const {
    samples.block_correlation = product_squares_ > 0.0 ? products_ / product_squares_ : 0.0;
    const double factor = correlation_factor(samples.block_correlation);
    const Vector2 s2 = typical(samples);
    for (std::size_t j = 0; j < squares_.size(); ++j) {
        samples.blocks[j] = blocks_[j];
        if (samples.count[j] > 0.0)
            samples.sigma[j] = {factor * mixed(squares_[j].x, blocks_[j], s2.x / samples.count[j]),
                                factor * mixed(squares_[j].y, blocks_[j], s2.y / samples.count[j])};
    }
}

} // namespace rodwake::measure
