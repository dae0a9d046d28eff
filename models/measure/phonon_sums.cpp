#include "phonon_sums.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
using Runs = std::span<const PhononAccumulator>;
using Block = PhononAccumulator::Block;
constexpr std::size_t most_blocks = 64;

void add(Block& sum, const Block& other) {
    const auto plus = [](Row& a, const Row& b) {
        for (std::size_t i = 0; i < a.size(); ++i)
            a[i] += b[i];
    };
    sum.frames += other.frames;
    sum.temperature += other.temperature;
    plus(sum.origins, other.origins);
    plus(sum.currents, other.currents);
}

/// Variance of u over a block's time, summed over its frames; it is taken block by block, so that what
/// creeps over longer times does not count.
Row displacement_squares(const Block& block, std::size_t modes) {
    Row squares(2 * modes, 0.0);
    if (block.displacements == 0.0)
        return squares;
    const auto mean_square = [&](std::size_t part, std::size_t k) {
        const double re = block.amplitude[2 * part * modes + k],
                     im = block.amplitude[(2 * part + 1) * modes + k];
        return (re * re + im * im) / block.displacements;
    };
    for (std::size_t part = 0; part < 2; ++part)
        for (std::size_t k = 0; k < modes; ++k)
            squares[part * modes + k] = block.amplitude[(4 + part) * modes + k] - mean_square(part, k);
    return squares;
}

PhononSums sums_of(const Block& block, std::size_t modes) {
    return {block, displacement_squares(block, modes), block.displacements};
}

void add(PhononSums& sum, const PhononSums& other) {
    add(sum.block, other.block);
    for (std::size_t i = 0; i < sum.squares.size(); ++i)
        sum.squares[i] += other.squares[i];
    sum.displacements += other.displacements;
}

} // namespace

std::vector<PhononSums> phonon_blocks(Runs runs) {
    std::vector<PhononSums> blocks;
    for (const PhononAccumulator& run : runs)
        for (std::size_t b = 0; b < run.blocks().size(); ++b) {
            const PhononSums sums = sums_of(run.blocks()[b], run.modes().size());
            if (b > 0 && 2.0 * sums.block.frames < run.blocks()[0].frames)
                add(blocks.back(), sums);
            else
                blocks.push_back(sums);
        }
    const std::size_t together = (blocks.size() + most_blocks - 1) / most_blocks;
    std::vector<PhononSums> groups;
    for (std::size_t b = 0; b < blocks.size(); ++b)
        if (b % together == 0)
            groups.push_back(blocks[b]);
        else
            add(groups.back(), blocks[b]);
    return groups;
}

PhononSums pooled(const std::vector<PhononSums>& blocks, std::size_t without) {
    const std::size_t first = without == 0 ? 1 : 0;
    PhononSums sum = blocks[first];
    for (std::size_t b = first + 1; b < blocks.size(); ++b)
        if (b != without)
            add(sum, blocks[b]);
    return sum;
}

std::vector<MirrorModes> mirror_modes(std::span<const PhononAccumulator::Mode> modes) {
    std::vector<MirrorModes> classes;
    for (std::size_t k = 0; k < modes.size(); ++k) {
        const int n = std::abs(modes[k].n);
        auto found = std::ranges::find_if(
            classes, [&](const MirrorModes& c) { return c.m == modes[k].m && c.n == n; });
        if (found == classes.end())
            found = classes.insert(classes.end(), {modes[k].m, n, {}});
        found->members.emplace_back(k, modes[k].n < 0 ? -1.0 : 1.0);
    }
    std::ranges::stable_sort(classes, {}, [](const MirrorModes& c) { return c.m * c.m + c.n * c.n; });
    return classes;
}

CurrentCorrelations correlations_of(const PhononSums& sums, const MirrorModes& one, std::size_t modes,
                                    double beads) {
    const std::size_t lags = sums.block.origins.size();
    CurrentCorrelations c{Row(lags, 0.0), Row(lags, 0.0), Row(lags, 0.0)};
    for (std::size_t lag = 0; lag < lags; ++lag) {
        const double each = 1.0 / (beads * sums.block.origins[lag] * static_cast<double>(one.members.size()));
        const double* at = sums.block.currents.data() + 3 * modes * lag;
        for (const auto& [k, sign] : one.members) {
            c.LL[lag] += each * at[k];
            c.TT[lag] += each * at[modes + k];
            c.LT[lag] += each * sign * at[2 * modes + k];
        }
    }
    return c;
}

double polarisation_of(const CurrentCorrelations& c) {
    double dd = 0.0, dx = 0.0, xx = 0.0;
    for (std::size_t lag = 1; lag < c.LL.size(); ++lag) {
        const double d = 0.5 * (c.LL[lag] - c.TT[lag]), x = c.LT[lag];
        dd += d * d;
        dx += d * x;
        xx += x * x;
    }
    return 0.25 * std::atan2(2.0 * dx, dd - xx);
}

CurrentCorrelations turned(const CurrentCorrelations& c, double angle) {
    const double cs = std::cos(angle), sn = std::sin(angle);
    CurrentCorrelations t = c;
    for (std::size_t lag = 0; lag < c.LL.size(); ++lag) {
        t.LL[lag] = cs * cs * c.LL[lag] + 2.0 * cs * sn * c.LT[lag] + sn * sn * c.TT[lag];
        t.TT[lag] = sn * sn * c.LL[lag] - 2.0 * cs * sn * c.LT[lag] + cs * cs * c.TT[lag];
    }
    return t;
}

} // namespace rodwake::measure
