#include "pair_finder.hpp"

#include "cell_grid.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::granular {

namespace {

constexpr std::size_t chunk = 4096;          // pairs a task; does not change results
constexpr double window = 20.0;              // steps an inner list should last (measured: 12 to 30 are equally fast)
constexpr double first_skin = 0.5;           // of a radius, as are the limits
constexpr double least_skin = 0.2, most_skin = 1.0;
constexpr std::int64_t short_life = 400, long_life = 4000; // steps of an outer list

std::size_t chunks_of(std::size_t count) { return (count + chunk - 1) / chunk; }

} // namespace

PairFinder::PairFinder(const Bodies& bodies, double box)
    : box_(box), skin_(0.0), length_(bodies.radius.empty() ? box : *std::min_element(bodies.radius.begin(), bodies.radius.end())) {
    skin_ = first_skin * length_;
}

double PairFinder::furthest_moved(const Bodies& bodies) const {
    double furthest2 = 0.0;
    for (std::size_t i = 0; i < bodies.spheres(); ++i) {
        const double x = bodies.position[4 * i] - origin_[4 * i], y = bodies.position[4 * i + 1] - origin_[4 * i + 1];
        furthest2 = std::max(furthest2, x * x + y * y);
    }
    return std::sqrt(furthest2);
}

void PairFinder::rebuild(const Bodies& bodies) {
    near_pairs(bodies.position, bodies.radius, bodies.beads, bodies.rod_of, box_, skin_ + flat_allowance_, outer_);
    origin_ = bodies.position;
    steps_since_rebuild_ = 0;
    ++rebuilds_;
}

void PairFinder::adapt_skin() {
    if (steps_since_rebuild_ < short_life)
        skin_ = std::min(1.25 * skin_, most_skin * length_);
    else if (steps_since_rebuild_ > long_life)
        skin_ = std::max(0.9 * skin_, least_skin * length_);
}

void PairFinder::adapt_allowances() {
    const double steps = static_cast<double>(std::max<std::int64_t>(steps_since_refresh_, 1));
    const auto towards = [&](double allowance, double moved) {
        const double wanted = window * moved / steps;
        return std::clamp(wanted, 1e-9 * length_, 0.5 * length_) * 0.5 + 0.5 * std::min(allowance, 0.5 * length_);
    };
    flat_allowance_ = towards(flat_allowance_, flat_);
    upright_allowance_ = towards(upright_allowance_, upright_);
}

template <class Test> void PairFinder::collect(std::size_t pairs, Team& team, const Test& test) {
    const std::size_t chunks = chunks_of(pairs);
    while (found_.size() < chunks)
        found_.push_back({std::vector<std::uint32_t>(chunk + 4), 0});
    team.run(chunks, [&](std::size_t c) {
        found_[c].count = test(c * chunk, std::min(pairs, (c + 1) * chunk), found_[c].index.data());
    });
}

void PairFinder::refresh(const Bodies& bodies, Team& team) {
    adapt_allowances();
    // A pair outside the outer list is at least the skin away and approaches by twice what a sphere moved, and then by the allowance.
    if (origin_.empty() || 2.0 * furthest_moved(bodies) > skin_) {
        if (!origin_.empty())
            adapt_skin();
        rebuild(bodies);
        outer_allowance_ = flat_allowance_;
    }
    flat_allowance_ = std::min(flat_allowance_, outer_allowance_);
    collect(outer_.size(), team, [&](std::size_t begin, std::size_t end, std::uint32_t* found) {
        return within_reach(bodies.position.data(), outer_, begin, end, box_, flat_allowance_, upright_allowance_, found);
    });
    inner_.clear();
    for (std::size_t c = 0; c < chunks_of(outer_.size()); ++c)
        for (std::size_t k = 0; k < found_[c].count; ++k) {
            inner_.pairs.push_back(outer_.pairs[found_[c].index[k]]);
            inner_.reach.push_back(outer_.reach[found_[c].index[k]]);
        }
    flat_ = upright_ = 0.0;
    steps_since_refresh_ = 0;
    ++refreshes_;
}

std::span<const Pair> PairFinder::find(const Bodies& bodies, const Range& velocities, double time_step, double slack,
                                       Team& team) {
    ++steps_since_refresh_;
    ++steps_since_rebuild_;
    const double x = velocities.width(0), y = velocities.width(1);
    flat_ += std::sqrt(x * x + y * y) * time_step;
    upright_ += velocities.width(2) * time_step + slack;
    if (!(flat_ <= flat_allowance_ && upright_ <= upright_allowance_) || origin_.empty())
        refresh(bodies, team);
    collect(inner_.size(), team, [&](std::size_t begin, std::size_t end, std::uint32_t* found) {
        return overlapping(bodies.position.data(), inner_, begin, end, box_, found);
    });
    overlapping_.clear();
    for (std::size_t c = 0; c < chunks_of(inner_.size()); ++c)
        for (std::size_t k = 0; k < found_[c].count; ++k)
            overlapping_.push_back(inner_.pairs[found_[c].index[k]]);
    return overlapping_;
}

} // namespace rodwake::granular
