// Mean-square displacement of beads that come and go, and what a camera adds to it.

#include "blocks.hpp"
#include "common_beads.hpp"
#include "rodwake/measure/microrheology.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
using Names = BeadNames;

} // namespace

void MicrorheologyAccumulator::correlate_named(const OctaveFrame& before, const OctaveFrame& now,
                                               LagSums& sums) {
    double found = 0.0;
    std::array<Moved, groups> moved{};
    for_each_common(now.bead, before.bead, [&](std::size_t i, std::size_t j) {
        const double dx = now.x[i] - before.x[j], dy = now.y[i] - before.y[j];
        const std::size_t group = named_.group[now.bead[i]];
        sums.sum[group] += dx * dx + dy * dy;
        sums.pairs[group] += 1.0;
        found += 1.0;
        moved[group].x += dx;
        moved[group].y += dy;
        moved[group].beads += 1.0;
    });
    add_halves(sums, moved);
    const std::size_t beads = options_.kind ? std::max<std::size_t>(now.bead.size(), 1) : layout_.beads;
    const double origins = found / static_cast<double>(beads);
    sums.origins += origins;
    sums.time += origins * (now.time - before.time);
}

void MicrorheologyAccumulator::add_halves(LagSums& sums, std::span<const Moved, groups> moved) {
    if (!sees_a_part())
        return;
    Moved half[2];
    for (std::size_t g = 0; g < groups; ++g) {
        Moved& of = half[g < groups / 2 ? 0 : 1];
        of = {of.x + moved[g].x, of.y + moved[g].y, of.beads + moved[g].beads};
    }
    if (half[0].beads == 0.0 || half[1].beads == 0.0)
        return;
    const double x = half[0].x / half[0].beads - half[1].x / half[1].beads,
                 y = half[0].y / half[0].beads - half[1].y / half[1].beads;
    sums.halves += 0.25 * (x * x + y * y);
    sums.halves_origins += 1.0;
}

void MicrorheologyAccumulator::add_named(const Frame& frame) {
    NamedBeads& n = named_;
    n.start_x.resize(layout_.all_beads, std::nan(""));
    n.start_y.resize(layout_.all_beads, 0.0);
    n.group.resize(layout_.all_beads, 0);
    Names bead = names_of(frame);
    const auto size = static_cast<std::ptrdiff_t>(bead.size());
    Row x(frame.unwrapped_x.begin(), frame.unwrapped_x.begin() + size),
        y(frame.unwrapped_y.begin(), frame.unwrapped_y.begin() + size);

    // The drift is followed by the beads that are in this frame and in the one before.
    double step_x = 0.0, step_y = 0.0, both = 0.0;
    for_each_common(bead, n.last_bead, [&](std::size_t i, std::size_t j) {
        step_x += x[i] - n.last_x[j];
        step_y += y[i] - n.last_y[j];
        both += 1.0;
    });
    n.drift_x += both > 0.0 ? step_x / both : 0.0;
    n.drift_y += both > 0.0 ? step_y / both : 0.0;
    if (!bead.empty()) {
        n.last_bead = bead;
        n.last_x = x;
        n.last_y = y;
    }

    // Displacements since a bead's first frame, the drift taken off.
    for (std::size_t i = 0; i < bead.size(); ++i) {
        const std::uint32_t b = bead[i];
        if (std::isnan(n.start_x[b])) {
            n.start_x[b] = x[i] - n.drift_x;
            n.start_y[b] = y[i] - n.drift_y;
            const double group = frame.y[i] / layout_.box.y * static_cast<double>(groups);
            n.group[b] = static_cast<std::uint8_t>(std::min(static_cast<double>(groups - 1), group));
        }
        x[i] -= n.start_x[b] + n.drift_x;
        y[i] -= n.start_y[b] + n.drift_y;
    }
    if (options_.kind) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < bead.size(); ++i)
            if (frame.kind[i] == *options_.kind) {
                bead[kept] = bead[i];
                x[kept] = x[i];
                y[kept++] = y[i];
            }
        bead.resize(kept);
        x.resize(kept);
        y.resize(kept);
    }
    push(0, {times_.tick, frame.time, x, y, bead});
}

namespace {

constexpr double least_ratio = 0.2; // of the third displacement's growth to the second's

/// Intercept at lag 0 from those at 1, 2 and 3 times so many frames; NaN: they do not tell.
double intercept(const Row& msd, std::size_t frames) {
    const double first = msd[frames - 1], d1 = msd[2 * frames - 1] - first,
                 d2 = msd[3 * frames - 1] - msd[2 * frames - 1];
    if (!(d1 > 0.0 && d2 >= least_ratio * d1))
        return std::nan("");
    return d2 <= d1 ? first - d1 * d1 / d2 : first - 2.0 * d1 + d2;
}

} // namespace

std::optional<Estimate> camera_noise(const std::vector<LagBlock>& blocks) {
    if (blocks[0].sum.size() < 6)
        return std::nullopt;
    const Jackknife found = Jackknife::of(blocks, [](const Row& msd) {
        const double near = intercept(msd, 1), far = intercept(msd, 2);
        return Row{near, std::isnan(far) ? near : near - far};
    });
    const double scatter = found.error(0), noise = found.error(1),
                 differs = std::sqrt(std::max(0.0, found.all[1] * found.all[1] - noise * noise));
    if (!std::isfinite(scatter) || !std::isfinite(differs))
        return std::nullopt;
    return Estimate{found.all[0], std::hypot(scatter, differs), blocks.size()};
}

void take_off(std::vector<LagBlock>& blocks, double added) {
    for (LagBlock& block : blocks)
        for (std::size_t i = 0; i < block.sum.size(); ++i)
            block.sum[i] -= block.weight[i] * added;
}

} // namespace rodwake::measure
