#include "pair_finder.hpp"

#include "cell_grid.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::granular {

namespace {

constexpr std::size_t chunk = 4096; // pairs a task; does not change results
constexpr double inner_window = 25.0,
                 hot_window = 5.0; // steps; measured, half or twice as much costs a few per cent
constexpr double first_skin = 0.5; // of a radius, as are the limits
constexpr double least_skin = 0.2, most_skin = 1.5;
constexpr std::int64_t short_life = 400, long_life = 4000; // steps of an outer list

std::size_t chunks_of(std::size_t count) { return (count + chunk - 1) / chunk; }

} // namespace

PairFinder::PairFinder(const Bodies& bodies, double box)
    : box_(box), skin_(0.0),
      length_(bodies.radius.empty() ? box : *std::min_element(bodies.radius.begin(), bodies.radius.end())),
      inner_{{}, inner_window}, hot_{{}, hot_window} {
    skin_ = first_skin * length_;
}

void PairFinder::Watch::note(double in_plane_motion, double vertical_motion) {
    in_plane += in_plane_motion;
    vertical += vertical_motion;
    ++steps;
}

void PairFinder::Watch::adapt(double length) {
    const double per_step = window / static_cast<double>(std::max<std::int64_t>(steps, 1));
    const auto towards = [&](double allowance, double moved) {
        return (std::clamp(per_step * moved, 1e-9 * length, 0.5 * length) +
                std::min(allowance, 0.5 * length)) /
               2.0;
    };
    in_plane_allowance = towards(in_plane_allowance, in_plane);
    vertical_allowance = towards(vertical_allowance, vertical);
}

double PairFinder::furthest_moved(const Bodies& bodies) const {
    double furthest2 = 0.0;
    for (std::size_t i = 0; i < bodies.spheres(); ++i) {
        const double x = bodies.position[4 * i] - origin_[4 * i],
                     y = bodies.position[4 * i + 1] - origin_[4 * i + 1];
        furthest2 = std::max(furthest2, x * x + y * y);
    }
    return std::sqrt(furthest2);
}

void PairFinder::rebuild(const Bodies& bodies) {
    near_pairs(bodies.position, bodies.radius, bodies.beads, bodies.rod_of, box_,
               skin_ + inner_.in_plane_allowance, outer_);
    origin_ = bodies.position;
    outer_allowance_ = inner_.in_plane_allowance;
    steps_since_rebuild_ = 0;
    ++rebuilds_;
}

void PairFinder::adapt_skin() {
    if (steps_since_rebuild_ < short_life)
        skin_ = std::min(1.25 * skin_, most_skin * length_);
    else if (steps_since_rebuild_ > long_life)
        skin_ = std::max(0.9 * skin_, least_skin * length_);
}

template<class Test>
void PairFinder::collect(std::size_t pairs, Team& team, const Test& test) {
    const std::size_t chunks = chunks_of(pairs);
    while (found_.size() < chunks)
        found_.push_back({std::vector<std::uint32_t>(chunk + 8), 0});
    team.run(chunks, [&](std::size_t c) {
        found_[c].count = test(c * chunk, std::min(pairs, (c + 1) * chunk), found_[c].index.data());
    });
}

void PairFinder::draw(const Bodies& bodies, const PairList& from, Watch& watch, Team& team) {
    collect(from.size(), team, [&](std::size_t begin, std::size_t end, std::uint32_t* found) {
        return within_reach(bodies.position.data(), from, begin, end, box_, watch.in_plane_allowance,
                            watch.vertical_allowance, found);
    });
    std::size_t total = 0, count = 0;
    for (std::size_t c = 0; c < chunks_of(from.size()); ++c)
        total += found_[c].count;
    watch.list.pairs.resize(total);
    watch.list.reach.resize(total);
    for (std::size_t c = 0; c < chunks_of(from.size()); ++c)
        for (std::size_t k = 0; k < found_[c].count; ++k, ++count) {
            watch.list.pairs[count] = from.pairs[found_[c].index[k]];
            watch.list.reach[count] = from.reach[found_[c].index[k]];
        }
    watch.in_plane = watch.vertical = 0.0;
    watch.steps = 0;
}

void PairFinder::refresh(const Bodies& bodies, Team& team) {
    inner_.adapt(length_);
    // A pair outside the outer list is at least the skin away and approaches by twice what a sphere moved,
    // and then by the allowance.
    if (origin_.empty() || 2.0 * furthest_moved(bodies) > skin_) {
        if (!origin_.empty())
            adapt_skin();
        rebuild(bodies);
    }
    inner_.in_plane_allowance = std::min(inner_.in_plane_allowance, outer_allowance_);
    draw(bodies, outer_, inner_, team);
    ++refreshes_;
}

std::span<const Pair> PairFinder::find(const Bodies& bodies, const Range& velocities, double time_step,
                                       double slack, Team& team) {
    ++steps_since_rebuild_;
    const double x = velocities.width(0), y = velocities.width(1);
    const double in_plane = std::sqrt(x * x + y * y) * time_step,
                 vertical = velocities.width(2) * time_step + slack;
    inner_.note(in_plane, vertical);
    hot_.note(in_plane, vertical);
    const bool stale = inner_.spent() || origin_.empty();
    if (stale)
        refresh(bodies, team);
    if (stale || hot_.spent()) {
        hot_.adapt(length_);
        draw(bodies, inner_.list, hot_, team);
    }
    collect(hot_.list.size(), team, [&](std::size_t begin, std::size_t end, std::uint32_t* found) {
        return overlapping(bodies.position.data(), hot_.list, begin, end, box_, found);
    });
    overlapping_.clear();
    for (std::size_t c = 0; c < chunks_of(hot_.list.size()); ++c)
        for (std::size_t k = 0; k < found_[c].count; ++k)
            overlapping_.push_back(hot_.list.pairs[found_[c].index[k]]);
    return overlapping_;
}

} // namespace rodwake::granular
