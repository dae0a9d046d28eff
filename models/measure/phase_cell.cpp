#include "phase_cell.hpp"

#include "plane_waves.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr int newton_steps = 8;

} // namespace

PhaseCell::PhaseCell(const std::vector<PhaseBlock>& blocks, const std::vector<CellPart>& parts)
    : blocks_(blocks), sums_(blocks.size()) {
    for (std::size_t b = 0; b < blocks.size(); ++b)
        for (const CellPart& part : parts)
            add(blocks[b], part, sums_[b]);
}

void PhaseCell::add(const PhaseBlock& block, const CellPart& part, Sums& to) {
    const double* from = &block.sums[part.bin * PhaseAccumulator::channels];
    if (from[PhaseAccumulator::beads] == 0.0)
        return;
    const bool moved = part.difference != Vector2{};
    const Phases back =
        moved ? plane_waves(block.g, -part.difference.x, -part.difference.y) : Phases{1.0, 1.0, 1.0};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto z = times({from[2 * k], from[2 * k + 1]}, back[k]);
        to[2 * k] += part.weight * z.real();
        to[2 * k + 1] += part.weight * z.imag();
    }
    for (const std::size_t c :
         {PhaseAccumulator::beads, PhaseAccumulator::place_x, PhaseAccumulator::place_y})
        to[c] += part.weight * from[c];
}

double PhaseCell::total(std::size_t channel) const {
    double sum = 0.0;
    for (const auto& block : sums_)
        sum += block[channel];
    return sum;
}

void PhaseCell::solve(Vector2& u) {
    for (int step = 0; step < newton_steps; ++step) {
        look(u);
        Vector2 sum;
        for (const Vector2& slope : slopes_) {
            sum.x += slope.x;
            sum.y += slope.y;
        }
        const auto move = inverse(sum);
        if (!move)
            return;
        const double size = std::hypot(move->x, move->y) * longest_;
        const double part = size > 0.5 ? 0.5 / size : 1.0; // at most half a radian
        u.x += part * move->x;
        u.y += part * move->y;
        if (size < 1e-8) // the next step would be the square of it
            return;
    }
}

std::vector<Vector2> PhaseCell::pulls(const Vector2& u) {
    look(u);
    std::vector<Vector2> result(slopes_.size());
    for (std::size_t b = 0; b < slopes_.size(); ++b)
        result[b] = inverse(slopes_[b]).value_or(Vector2{});
    return result;
}

std::vector<bool> PhaseCell::present() const {
    std::vector<bool> result(sums_.size());
    for (std::size_t b = 0; b < sums_.size(); ++b)
        result[b] = sums_[b][PhaseAccumulator::beads] > 0.0;
    return result;
}

double PhaseCell::coherence() const {
    return std::clamp(in_phase_ / (3.0 * total(PhaseAccumulator::beads)), 0.0, 1.0);
}

/// Slope of each block's likelihood and curvature of all.
void PhaseCell::look(const Vector2& u) {
    xx_ = xy_ = yy_ = in_phase_ = longest_ = 0.0;
    slopes_.assign(sums_.size(), {});
    for (std::size_t b = 0; b < sums_.size(); ++b) {
        if (sums_[b][PhaseAccumulator::beads] == 0.0)
            continue;
        const Phases back = plane_waves(blocks_[b].g, -u.x, -u.y);
        for (std::size_t k = 0; k < 3; ++k)
            look(blocks_[b].g[k], times({sums_[b][2 * k], sums_[b][2 * k + 1]}, back[k]), slopes_[b]);
    }
}

void PhaseCell::look(const Vector2& g, const std::complex<double>& z, Vector2& slope) {
    slope.x += g.x * z.imag();
    slope.y += g.y * z.imag();
    xx_ += g.x * g.x * z.real();
    xy_ += g.x * g.y * z.real();
    yy_ += g.y * g.y * z.real();
    in_phase_ += z.real();
    longest_ = std::max(longest_, std::abs(g.x) + std::abs(g.y));
}

std::optional<Vector2> PhaseCell::inverse(const Vector2& v) const {
    const double determinant = xx_ * yy_ - xy_ * xy_;
    if (!(xx_ > 0.0 && determinant > 1e-6 * xx_ * yy_))
        return std::nullopt;
    return Vector2{(yy_ * v.x - xy_ * v.y) / determinant, (xx_ * v.y - xy_ * v.x) / determinant};
}

} // namespace rodwake::measure
