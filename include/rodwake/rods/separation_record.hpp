#pragma once
// What a run remembers of the separations between its rods.

#include "rodwake/core/encounter.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/integrate/ode.hpp"
#include "rodwake/rods/body.hpp"
#include "rodwake/rods/separation.hpp"

#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace rodwake::rods {

/// Of more rods than this pairs are not followed one by one: their number grows as N^2, and how one of them
/// ends says little of a crowd.
inline constexpr std::size_t most_followed_rods = 100;

/// Of rods with bodies: the smallest gap between two of them at any time, and for how long each pair touched
/// in the last quarter of the run, from the steps of the solver.
struct BodyRecord {
    double smallest_gap = std::numeric_limits<double>::infinity();
    double smallest_gap_time = 0.0;
    double tail_start = 0.0;      ///< time at which the last quarter begins
    std::vector<double> touching; ///< time since then, of pair (a, b), a < b, at a N + b; empty for many rods
};

/// The smallest separation of all pairs at any time, and each pair's range over the last part of the run.
/// A plain value: it can be saved and taken up again.
struct SeparationRecord {
    Separation smallest;          ///< infinite for a single rod
    double smallest_time = 0.0;   ///< when that was
    double tail_start = 0.0;      ///< time at which the last part begins
    std::vector<TailWindow> late; ///< of pair (a, b), a < b, at a N + b; empty for one rod, and for many
    BodyRecord bodies = {};
};

/// `t_end`: end of the run, for the record of bodies.
SeparationRecord start_record(integrate::State y, double tail_start, Box box = {},
                              const BodyForces& bodies = {}, double t_end = 0.0);
/// Time derivatives of a state.
using StateRates = std::function<void(integrate::State y, std::span<double> ydot)>;
/// The last part is looked at when it begins, on the cubic through the step and its rates, and at every step
/// end after: so it hardly depends on where the steps end.
/// Bodies push rods aside: then places inside the step follow the rates too, not the headings.
void add_step(SeparationRecord& record, const integrate::Step& step, const StateRates& rates, Box box = {},
              const BodyForces& bodies = {});

/// The pair that touched for bound_share of the last quarter, the longest of all; needs a run to its end.
std::optional<Separation> bound_pair(const SeparationRecord& record, integrate::State y, double t_end,
                                     Box box);
inline constexpr double bound_share = 0.9, bound_part = 0.25; ///< bound_part: the last quarter of a run

// How an encounter of two rods of the theory ends; core/encounter.hpp has the endings and their criteria.
//
// Of several pairs: contact wins over pursuit, pursuit over undecided; escape means that every pair escapes.
// Of more than most_followed_rods rods (separation_record.hpp) only contact is decided.

/// Ending of the pair (a, b) from the final state and its time derivative; never `contact`.
/// `late` as separation_record.hpp keeps it. In a periodic box of the nearest images (separation.hpp).
Ending classify_pair(integrate::State y, integrate::State ydot, std::size_t a, std::size_t b,
                     const TailWindow& late, const EndingCriteria& criteria = {},
                     std::optional<PeriodicBox> box = {});

} // namespace rodwake::rods
