#include "pair_finder.hpp"

#include "rodwake/core/cell_list.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::granular {

namespace {

constexpr double window = 12.0; // steps an inner list should last; half or twice as much costs a few per cent
constexpr double first_skin = 0.5; // of a radius, as are the limits
constexpr double least_skin = 0.2, most_skin = 1.5;
constexpr double most_allowance = 0.5;
constexpr std::int64_t short_life = 400, long_life = 4000; // steps of an outer list

std::size_t blocks_in(const Bodies& bodies) {
    return (bodies.spheres() + beads_per_block - 1) / beads_per_block;
}

} // namespace

PairFinder::PairFinder(const Bodies& bodies, const PeriodicBox& box)
    : box_(box),
      length_(bodies.radius.empty() ? box.shorter()
                                    : *std::min_element(bodies.radius.begin(), bodies.radius.end())),
      skin_(first_skin * length_), allowance_(0.02 * length_) {}

void PairFinder::draw(const Bodies& bodies, ThreadPool& team) {
    const std::size_t parts = outer_parts_.size() - 1;
    found_.resize(parts);
    blocks_.resize(parts);
    team.run(parts, [&](std::size_t c) {
        const std::size_t begin = outer_parts_[c], end = outer_parts_[c + 1];
        found_[c].index.resize(end - begin + 8);
        found_[c].count = within_reach(bodies.position.data(), outer_, begin, end, box_, allowance_,
                                       found_[c].index.data());
    });
    inner_parts_.assign(1, 0);
    for (const ThreadPairs& found : found_)
        inner_parts_.push_back(inner_parts_.back() + found.count);
    inner_.common = outer_.common;
    inner_.resize(inner_parts_.back());
    team.run(parts, [&](std::size_t c) {
        for (std::size_t k = 0; k < found_[c].count; ++k)
            inner_.copy(inner_parts_[c] + k, outer_, found_[c].index[k]);
        // The blocks of its beads: its own, and those of the second beads.
        std::vector<std::uint32_t>& blocks = blocks_[c];
        blocks.clear();
        if (bodies.is_bead(c * beads_per_block))
            blocks.push_back(static_cast<std::uint32_t>(c));
        std::size_t last = c;
        for (std::size_t k = inner_parts_[c]; k < inner_parts_[c + 1]; ++k) {
            const std::size_t second = inner_.pairs[k].second, block = second / beads_per_block;
            if (!bodies.is_bead(second) || block == last)
                continue;
            last = block;
            if (std::ranges::find(blocks, block) == blocks.end())
                blocks.push_back(static_cast<std::uint32_t>(block));
        }
    });
    drawn_ = bodies.position;
    furthest_.assign(blocks_in(bodies), 0.0);
    steps_since_draw_ = 0;
    ++refreshes_;
}

void PairFinder::refresh(const Bodies& bodies, ThreadPool& team) {
    // A pair outside the outer list is at least the skin away beside the allowance, and approaches by twice
    // what a sphere moved.
    furthest_from_origin_ += furthest();
    if (!origin_.empty() && 2.0 * furthest_from_origin_ > skin_) {
        std::vector<std::size_t> all(blocks_in(bodies));
        std::iota(all.begin(), all.end(), std::size_t{0});
        measure(bodies, origin_, all, team);
        furthest_from_origin_ = furthest();
        if (2.0 * furthest_from_origin_ > skin_) {
            if (steps_since_rebuild_ < short_life)
                skin_ = std::min(1.25 * skin_, most_skin * length_);
            else if (steps_since_rebuild_ > long_life)
                skin_ = std::max(0.9 * skin_, least_skin * length_);
            origin_.clear();
        }
    }
    if (origin_.empty()) {
        outer_parts_ = near_pairs(bodies, box_, skin_ + allowance_, team, outer_);
        origin_ = bodies.position;
        furthest_from_origin_ = 0.0;
        outer_allowance_ = allowance_;
        steps_since_rebuild_ = 0;
        ++rebuilds_;
    }
    allowance_ = std::min(allowance_, outer_allowance_);
    draw(bodies, team);
}

double PairFinder::furthest() const { return furthest_.empty() ? 0.0 : *std::ranges::max_element(furthest_); }

/// How far the spheres of some blocks are from where they were before.
void PairFinder::measure(const Bodies& bodies, const Rows& before, std::span<const std::size_t> blocks,
                         ThreadPool& team) {
    team.run(blocks.size(), [&](std::size_t k) {
        const std::size_t begin = blocks[k] * beads_per_block,
                          end = std::min(bodies.spheres(), begin + beads_per_block);
        furthest_[blocks[k]] = furthest_moved(bodies.position, before, begin, end);
    });
}

/// Whether pairs outside the inner list may touch.
bool PairFinder::stale(const Bodies& bodies, std::span<const double> fastest, double time_step,
                       ThreadPool& team) {
    ++steps_since_draw_;
    ++steps_since_rebuild_;
    fastest_.resize(blocks_in(bodies), 0.0);
    furthest_.resize(blocks_in(bodies), 0.0);
    // The fastest of each block and of those whose beads may push its own.
    const auto of_block = [&](std::size_t b) { return fastest[std::min(b, fastest.size() - 1)]; };
    std::vector<double> around(furthest_.size());
    for (std::size_t b = 0; b < around.size(); ++b)
        around[b] = of_block(b);
    for (std::size_t b = 0; b < blocks_.size(); ++b)
        for (const std::uint32_t other : blocks_[b]) {
            around[b] = std::max(around[b], of_block(other));
            around[other] = std::max(around[other], of_block(b));
        }
    std::vector<std::size_t> far;
    for (std::size_t b = 0; b < furthest_.size(); ++b) {
        furthest_[b] +=
            (2.0 * around[b] + fastest_[b]) * time_step; // by its flight, and by the impulse before
        fastest_[b] = around[b];
        if (2.0 * furthest_[b] > allowance_)
            far.push_back(b);
    }
    if (drawn_.empty())
        return true;
    measure(bodies, drawn_, far, team);
    return 2.0 * furthest() > allowance_;
}

bool PairFinder::likely_to_hold(double time_step) const {
    for (std::size_t b = 0; b < furthest_.size(); ++b)
        if (2.0 * (furthest_[b] + fastest_[b] * time_step) > allowance_)
            return false;
    return !drawn_.empty();
}

void PairFinder::test(std::size_t part, const Bodies& bodies) {
    found_[part].count = overlapping(bodies.position.data(), inner_, inner_parts_[part],
                                     inner_parts_[part + 1], box_, found_[part].index.data());
}

std::span<const Pair> PairFinder::find(const Bodies& bodies, std::span<const double> fastest,
                                       double time_step, ThreadPool& team, bool tested) {
    if (stale(bodies, fastest, time_step, team)) {
        // Towards what two spheres that move as the furthest did approach within the window.
        const double steps = static_cast<double>(std::max<std::int64_t>(steps_since_draw_, 1));
        const double wanted = 2.0 * furthest() * window / steps;
        allowance_ = (std::clamp(wanted, 1e-9 * length_, most_allowance * length_) + allowance_) / 2.0;
        refresh(bodies, team);
        tested = false;
    }
    if (!tested)
        team.run(parts(), [&](std::size_t part) { test(part, bodies); });
    overlapping_.clear();
    for (const ThreadPairs& found : found_)
        for (std::size_t k = 0; k < found.count; ++k)
            overlapping_.push_back(inner_.pairs[found.index[k]]);
    return overlapping_;
}

namespace {

/// Columns of the packed rows.
std::vector<double> column(const Rows& position, std::size_t count, std::size_t k) {
    std::vector<double> out(count);
    for (std::size_t i = 0; i < count; ++i)
        out[i] = position[4 * i + k];
    return out;
}

/// The spheres with higher numbers than i nearer than their radii and the skin in the plane: how many.
/// Without branches on the answer, which nobody can predict.
template<bool equal>
std::size_t partners_of(std::size_t i, const Bodies& bodies, const CellList& cells, const PeriodicBox& box,
                        double skin, std::vector<std::uint32_t>& partners) {
    const double x = bodies.position[4 * i], y = bodies.position[4 * i + 1],
                 radius = bodies.radius_of<equal>(i) + skin;
    std::size_t count = 0;
    cells.cells_around(cells.column(x), cells.row(y), [&](std::size_t begin, std::size_t end) {
        if (begin == end || cells.member()[end - 1] <= i)
            return; // numbers rise within a cell
        partners.resize(std::max(partners.size(), count + end - begin));
        std::uint32_t* out = partners.data() + count;
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t j = cells.member()[k];
            const double dx = nearest_image_rounded(x - cells.x()[k], box.x),
                         dy = nearest_image_rounded(y - cells.y()[k], box.y),
                         reach = radius + bodies.radius_of<equal>(j);
            *out = j;
            out += (j > i) & (dx * dx + dy * dy < reach * reach);
        }
        count = static_cast<std::size_t>(out - partners.data());
    });
    if (!bodies.is_bead(i))
        count =
            static_cast<std::size_t>(std::remove_if(partners.data(), partners.data() + count,
                                                    [&](std::uint32_t j) { return bodies.same_rod(i, j); }) -
                                     partners.data());
    return count;
}

/// The pairs whose first sphere is one of [begin, end).
void pairs_of(const Bodies& bodies, const CellList& cells, const PeriodicBox& box, double skin,
              std::size_t begin, std::size_t end, PairList& found) {
    std::vector<std::uint32_t> partners;
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t count = bodies.equal_beads
                                      ? partners_of<true>(i, bodies, cells, box, skin, partners)
                                      : partners_of<false>(i, bodies, cells, box, skin, partners);
        std::sort(partners.data(), partners.data() + count);
        for (std::size_t k = 0; k < count; ++k) {
            const std::uint32_t j = partners[k];
            found.pairs.push_back({static_cast<std::uint32_t>(i), j});
            if (!(found.common > 0.0))
                found.reach.push_back(bodies.radius[i] + bodies.radius[j]);
        }
    }
}

} // namespace

std::vector<std::size_t> near_pairs(const Bodies& bodies, const PeriodicBox& box, double skin,
                                    ThreadPool& team, PairList& list) {
    list.clear();
    const std::size_t count = bodies.spheres();
    if (count < 2)
        return {0};
    // The two largest may meet; most pairs are of beads, so cells fit the pair of the largest kinds present.
    const auto [least, most] = std::ranges::minmax(bodies.radius);
    const std::vector<double> x = column(bodies.position, count, 0), y = column(bodies.position, count, 1);
    const CellList cells(x, y, box, 2.0 * most + skin);
    list.common = least == most ? least + most : 0.0;
    std::vector<PairList> found(blocks_in(bodies), list);
    team.run(found.size(), [&](std::size_t c) {
        pairs_of(bodies, cells, box, skin, c * beads_per_block, std::min(count, (c + 1) * beads_per_block),
                 found[c]);
    });
    return gather(found, team, list);
}

} // namespace rodwake::granular
