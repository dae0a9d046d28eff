#include "pair_finder.hpp"

#include "rodwake/core/cell_list.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::granular {

namespace {

constexpr std::size_t pairs_a_task = 4096; // pairs a task; does not change results
constexpr double window = 12.0; // steps an inner list should last; half or twice as much costs a few per cent
constexpr double first_skin = 0.5; // of a radius, as are the limits
constexpr double least_skin = 0.2, most_skin = 1.5;
constexpr double most_allowance = 0.5;
constexpr std::int64_t short_life = 400, long_life = 4000; // steps of an outer list

std::size_t chunks_of(std::size_t count) { return (count + pairs_a_task - 1) / pairs_a_task; }

} // namespace

PairFinder::PairFinder(const Bodies& bodies, const PeriodicBox& box)
    : box_(box),
      length_(bodies.radius.empty() ? box.shorter()
                                    : *std::min_element(bodies.radius.begin(), bodies.radius.end())),
      skin_(first_skin * length_), allowance_(0.02 * length_) {}

void PairFinder::rebuild(const Bodies& bodies, Team& team) {
    near_pairs(bodies, box_, skin_ + allowance_, team, outer_);
    origin_ = bodies.position;
    outer_allowance_ = allowance_;
    steps_since_rebuild_ = 0;
    ++rebuilds_;
}

void PairFinder::adapt_skin() {
    if (steps_since_rebuild_ < short_life)
        skin_ = std::min(1.25 * skin_, most_skin * length_);
    else if (steps_since_rebuild_ > long_life)
        skin_ = std::max(0.9 * skin_, least_skin * length_);
}

/// Towards what two spheres that move as the furthest did approach within the window.
void PairFinder::adapt_allowance(double furthest) {
    const double steps = static_cast<double>(std::max<std::int64_t>(steps_since_draw_, 1));
    const double wanted = 2.0 * furthest * window / steps;
    allowance_ = (std::clamp(wanted, 1e-9 * length_, most_allowance * length_) + allowance_) / 2.0;
}

template<class Test>
void PairFinder::collect(std::size_t pairs, Team& team, const Test& test) {
    const std::size_t chunks = chunks_of(pairs);
    while (found_.size() < chunks)
        found_.push_back({std::vector<std::uint32_t>(pairs_a_task + 8), 0});
    team.run(chunks, [&](std::size_t c) {
        found_[c].count =
            test(c * pairs_a_task, std::min(pairs, (c + 1) * pairs_a_task), found_[c].index.data());
    });
}

void PairFinder::draw(const Bodies& bodies, Team& team) {
    collect(outer_.size(), team, [&](std::size_t begin, std::size_t end, std::uint32_t* found) {
        return within_reach(bodies.position.data(), outer_, begin, end, box_, allowance_, found);
    });
    const std::size_t chunks = chunks_of(outer_.size());
    std::vector<std::size_t> begin(chunks + 1, 0);
    for (std::size_t c = 0; c < chunks; ++c)
        begin[c + 1] = begin[c] + found_[c].count;
    inner_.common = outer_.common;
    inner_.resize(begin[chunks]);
    team.run(chunks, [&](std::size_t c) {
        for (std::size_t k = 0; k < found_[c].count; ++k)
            inner_.copy(begin[c] + k, outer_, found_[c].index[k]);
    });
    drawn_ = bodies.position;
    furthest_ = 0.0;
    steps_since_draw_ = 0;
    ++refreshes_;
}

void PairFinder::refresh(const Bodies& bodies, Team& team) {
    // A pair outside the outer list is at least the skin away beside the allowance, and approaches by twice
    // what a sphere moved.
    if (origin_.empty() || 2.0 * furthest_moved(bodies.position, origin_, team) > skin_) {
        if (!origin_.empty())
            adapt_skin();
        rebuild(bodies, team);
    }
    allowance_ = std::min(allowance_, outer_allowance_);
    draw(bodies, team);
}

/// Whether pairs outside the inner list may touch.
bool PairFinder::stale(const Bodies& bodies, double moved, Team& team) {
    furthest_ += moved;
    ++steps_since_draw_;
    ++steps_since_rebuild_;
    if (drawn_.empty())
        return true;
    if (2.0 * furthest_ <= allowance_)
        return false;
    furthest_ = furthest_moved(bodies.position, drawn_, team);
    return 2.0 * furthest_ > allowance_;
}

std::span<const Pair> PairFinder::find(const Bodies& bodies, double fastest, double time_step, Team& team) {
    const double moved = (2.0 * fastest + fastest_) * time_step; // by its flight, and by the impulse before
    fastest_ = fastest;
    if (stale(bodies, moved, team)) {
        adapt_allowance(furthest_);
        refresh(bodies, team);
    }
    collect(inner_.size(), team, [&](std::size_t begin, std::size_t end, std::uint32_t* found) {
        return overlapping(bodies.position.data(), inner_, begin, end, box_, found);
    });
    overlapping_.clear();
    for (std::size_t c = 0; c < chunks_of(inner_.size()); ++c)
        for (std::size_t k = 0; k < found_[c].count; ++k)
            overlapping_.push_back(inner_.pairs[found_[c].index[k]]);
    return overlapping_;
}

namespace {

constexpr std::size_t spheres_a_task = 2048; // spheres a task; does not change results

/// Columns of the packed rows.
std::vector<double> column(const Rows& position, std::size_t count, std::size_t k) {
    std::vector<double> out(count);
    for (std::size_t i = 0; i < count; ++i)
        out[i] = position[4 * i + k];
    return out;
}

/// The spheres with higher numbers than i nearer than their radii and the skin in the plane: how many.
/// Without branches on the answer, which nobody can predict.
std::size_t partners_of(std::size_t i, const Bodies& bodies, const CellList& cells, const PeriodicBox& box,
                        double skin, std::vector<std::uint32_t>& partners) {
    const double x = bodies.position[4 * i], y = bodies.position[4 * i + 1],
                 radius = bodies.radius_of(i) + skin;
    std::size_t count = 0;
    cells.cells_around(cells.column(x), cells.row(y), [&](std::size_t begin, std::size_t end) {
        partners.resize(std::max(partners.size(), count + end - begin));
        std::uint32_t* out = partners.data() + count;
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t j = cells.member()[k];
            const double dx = nearest_image_rounded(x - cells.x()[k], box.x),
                         dy = nearest_image_rounded(y - cells.y()[k], box.y),
                         reach = radius + bodies.radius_of(j);
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
        const std::size_t count = partners_of(i, bodies, cells, box, skin, partners);
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

void near_pairs(const Bodies& bodies, const PeriodicBox& box, double skin, Team& team, PairList& list) {
    list.clear();
    const std::size_t count = bodies.spheres();
    if (count < 2)
        return;
    // The two largest may meet; most pairs are of beads, so cells fit the pair of the largest kinds present.
    const auto [least, most] = std::ranges::minmax(bodies.radius);
    const std::vector<double> x = column(bodies.position, count, 0), y = column(bodies.position, count, 1);
    const CellList cells(x, y, box, 2.0 * most + skin);
    list.common = least == most ? least + most : 0.0;
    std::vector<PairList> found((count + spheres_a_task - 1) / spheres_a_task, list);
    team.run(found.size(), [&](std::size_t c) {
        pairs_of(bodies, cells, box, skin, c * spheres_a_task, std::min(count, (c + 1) * spheres_a_task),
                 found[c]);
    });
    gather(found, team, list);
}

} // namespace rodwake::granular
