#pragma once
// Which spheres overlap, without asking every pair at every step.
//
// Two lists, the second drawn from the first: an outer one of pairs near in the plane, rebuilt from cells
// when a sphere has moved half its skin, and an inner one of those that may touch within some 12 steps. Only
// motion in the plane counts: spheres further apart in the plane than their radii touch at no height, and
// height changes fast in a shaken layer. How far spheres have moved is measured, but not at each step: speeds
// tell how long the last measure holds. Allowance and skin follow the measured motion. What is found never
// depends on the lists, only the time it takes: pairs come in the order (first, second).

#include "bodies.hpp"
#include "kernels.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/granular/simulation.hpp"

#include <span>

namespace rodwake::granular {

class PairFinder {
public:
    PairFinder(const Bodies& bodies, const PeriodicBox& box);

    /// The pairs that overlap in space after a step in which no sphere of a block was faster than its
    /// `fastest` in the plane, m/s; the last counts for all blocks from it on. Impulses since the last call
    /// may have moved spheres besides, by what they changed velocities for less than a step
    /// (pair_contacts.hpp). `tested`: all parts were, after the flight, which counts if the lists turn out to
    /// hold. Valid until the next call.
    std::span<const Pair> find(const Bodies& bodies, std::span<const double> fastest, double time_step,
                               ThreadPool& team, bool tested = false);

    // Tests while the beads that have just flown are still in the cache. A part are the pairs whose first
    // sphere is in one block of beads.

    /// Whether the lists will probably hold after the next step.
    bool likely_to_hold(double time_step) const;
    std::size_t parts() const { return found_.size(); }
    /// The blocks that must have flown before the test.
    std::span<const std::uint32_t> blocks_of(std::size_t part) const { return blocks_[part]; }
    void test(std::size_t part, const Bodies& bodies);

    SimulationCost cost() const { return {rebuilds_, refreshes_, outer_.size(), inner_.size(), skin_}; }

private:
    void refresh(const Bodies& bodies, ThreadPool& team);
    void draw(const Bodies& bodies, ThreadPool& team);
    bool stale(const Bodies& bodies, std::span<const double> fastest, double time_step, ThreadPool& team);
    void measure(const Bodies& bodies, const Rows& before, std::span<const std::size_t> blocks,
                 ThreadPool& team);
    double furthest() const;

    PeriodicBox box_;
    double length_;    ///< scale for limits, a bead radius, m
    double skin_;      ///< of the outer list, beside the allowance it was built for, m
    double allowance_; ///< pairs nearer than that in the plane are in the inner list, m
    double outer_allowance_ = 0.0;
    std::vector<double> fastest_; ///< of each block in the step before, m/s
    std::vector<double>
        furthest_; ///< no sphere of a block has moved further since the inner list was drawn, m
    double furthest_from_origin_ = 0.0; ///< the same of all since the outer list was built
    PairList outer_, inner_;
    std::vector<std::size_t> outer_parts_, inner_parts_; ///< where each part begins, and the end
    std::vector<std::vector<std::uint32_t>> blocks_;     ///< of each part of the inner list
    Rows origin_, drawn_; ///< positions when the outer list was built and the inner one drawn
    std::int64_t steps_since_rebuild_ = 0, steps_since_draw_ = 0;
    std::size_t rebuilds_ = 0, refreshes_ = 0;
    struct ThreadPairs {
        std::vector<std::uint32_t> index;
        std::size_t count = 0;
    };
    std::vector<ThreadPairs> found_; ///< one a part
    std::vector<Pair> overlapping_;
};

// Neighbours in the periodic plane by cells.

/// All pairs of spheres nearer in the plane than the sum of their radii plus `skin`, nearest images, ordered
/// (first, second); pairs of the same rod are left out. Returns where the pairs begin whose first sphere is
/// in each block, and the end.
std::vector<std::size_t> near_pairs(const Bodies& bodies, const PeriodicBox& box, double skin,
                                    ThreadPool& team, PairList& list);

} // namespace rodwake::granular
