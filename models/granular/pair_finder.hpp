#pragma once
// Which spheres overlap, without asking every pair at every step.
//
// Three lists, each drawn from the one before: an outer one of pairs near in the plane, rebuilt from cells
// when a sphere has moved half its skin; an inner one of those that may touch within some 25 steps; a hot one
// of those that may touch within the next few. Motion in the plane is slow and motion in height is fast (a
// shaken layer), so the inner and the hot list have one allowance for each. Allowances and skin follow the
// measured motion. What is found never depends on the lists, only the time it takes: pairs come in the order
// (first, second).

#include "bodies.hpp"
#include "kernels.hpp"
#include "rodwake/core/parallel.hpp"

#include <span>

namespace rodwake::granular {

class PairFinder {
public:
    PairFinder(const Bodies& bodies, double box);

    /// The pairs that overlap in space after a step in which velocities were in `velocities` and nothing
    /// else moved by more than `slack` in height, m. Valid until the next call.
    std::span<const Pair> find(const Bodies& bodies, const Range& velocities, double time_step, double slack,
                               Team& team);

    std::size_t rebuilds() const { return rebuilds_; }
    std::size_t refreshes() const { return refreshes_; }
    std::size_t inner_size() const { return inner_.list.size(); }
    std::size_t hot_size() const { return hot_.list.size(); }
    std::size_t outer_size() const { return outer_.size(); }
    double skin() const { return skin_; }

private:
    /// Pairs that cannot touch before bodies approach by more than the allowances are not in the list.
    struct Watch {
        PairList list;
        double window;                                             ///< steps it should last
        double in_plane = 0.0, vertical = 0.0;                     ///< moved since it was drawn, m
        double in_plane_allowance = 0.0, vertical_allowance = 0.0; ///< m
        std::int64_t steps = 0;                                    ///< since it was drawn

        void note(double in_plane_motion, double vertical_motion);
        bool spent() const { return !(in_plane <= in_plane_allowance && vertical <= vertical_allowance); }
        void adapt(double length);
    };

    void rebuild(const Bodies& bodies);
    void refresh(const Bodies& bodies, Team& team);
    void draw(const Bodies& bodies, const PairList& from, Watch& watch, Team& team);
    void adapt_skin();
    double furthest_moved(const Bodies& bodies) const;
    template<class Test>
    void collect(std::size_t pairs, Team& team, const Test& test);

    double box_, skin_, length_; ///< length_: scale for limits, a bead radius
    PairList outer_;
    Watch inner_, hot_;
    Rows origin_;                  ///< positions at the last rebuild
    double outer_allowance_ = 0.0; ///< in-plane allowance of the inner list that the outer list was built for
    std::int64_t steps_since_rebuild_ = 0;
    std::size_t rebuilds_ = 0, refreshes_ = 0;
    struct Found {
        std::vector<std::uint32_t> index;
        std::size_t count = 0;
    };
    std::vector<Found> found_; ///< one a chunk of pairs
    std::vector<Pair> overlapping_;
};

} // namespace rodwake::granular
