#pragma once
// The lanes of the pair integrator: what each holds, and what happens to one lane by itself (its start, a
// meeting inside a step, its end). The step of all lanes at once is in pair_steps.cpp.

#include "rodwake/rods/pair_batch.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rodwake::rods {

inline constexpr std::size_t most_lanes = 8;

/// One number a lane, as vectors are loaded and stored.
struct alignas(64) LaneNumbers {
    double at[most_lanes] = {};
    double& operator[](std::size_t lane) { return at[lane]; }
    double operator[](std::size_t lane) const { return at[lane]; }
};

/// States as in model.hpp: x_0, y_0, theta_0, x_1, y_1, theta_1; rates are their derivatives.
struct PairLanes {
    LaneNumbers active; ///< 1, or 0 for a lane without a pair
    LaneNumbers time, step, t_end, tail_start;
    LaneNumbers forced;         ///< length of the next step, to land on a meeting; 0: as error control says
    LaneNumbers contact_square; ///< of the contact distance; negative: never
    LaneNumbers state[6], rate[6];                ///< where the lane is
    LaneNumbers end_state[6], end_rate[6], tried; ///< where the attempted step of length `tried` ends
    LaneNumbers c_shear, nu, delta, inverse_nu;
    LaneNumbers kappa, gamma1, gamma2; ///< with the units of the kernels
    LaneNumbers start[6];
    LaneNumbers smallest, smallest_time;             ///< separation
    LaneNumbers late_least, late_most, late_turning; ///< TailWindow
    LaneNumbers most_turned, ahead_x, ahead_y;       ///< see PairResult
    LaneNumbers attempts, steps;
};

/// What of a lane no vector looks at.
struct LaneSearch {
    enum class Aim {
        none,
        look,
        root
    } aim = Aim::none;                  ///< why a step is forced: to see a closest approach, or contact
    double outside = 0.0, inside = 0.0; ///< steps that end before and after contact
    int tries = 0;
};

/// A vector of lanes and the pairs that it does.
class PairQueue {
public:
    /// `next`: which pair of the order is the next to be taken up, for all vectors that share them.
    PairQueue(std::span<const PairProblem> pairs, std::span<const std::size_t> order, std::size_t& next,
              const PairOptions& options, std::span<PairResult> results);

    /// Gives the first `count` lanes their first pairs.
    void fill(std::size_t count);
    bool done() const { return working_ == 0; }

    /// A step that passes a meeting or a closest approach. False: take it again, with the length now in
    /// `forced`.
    bool inspect(std::size_t lane);
    /// After the lane's step was taken, if it was the last: stores the result and takes up the next pair.
    void finish(std::size_t lane, PairEnding end);
    /// Whether the step just taken ended in contact.
    bool in_contact(std::size_t lane) const { return contact_[lane]; }
    /// Tells options().on_step of the steps that these lanes, a bit each, have taken.
    void report(std::uint32_t taken) const;
    /// True once: the rates of a lane with a new pair are not known yet.
    bool take_fresh();

    const PairOptions& options() const { return options_; }

    PairLanes lanes;

private:
    void load(std::size_t lane, const PairProblem& pair);
    void next(std::size_t lane);

    std::span<const PairProblem> pairs_;
    std::span<const std::size_t> order_;
    std::size_t& next_;
    const PairOptions& options_;
    std::span<PairResult> results_;
    std::size_t working_ = 0;
    bool fresh_ = false;
    std::size_t pair_[most_lanes] = {};
    bool contact_[most_lanes] = {};
    LaneSearch search_[most_lanes];
};

/// Advances the lanes of both vectors until no pair is left.
void run_pairs(PairQueue& first, PairQueue& second, bool polar);

/// Number of lanes of the instruction set in use.
std::size_t pair_lane_count();

} // namespace rodwake::rods
