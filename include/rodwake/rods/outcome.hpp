#pragma once
// How an encounter of two rods of the theory ends; core/encounter.hpp has the endings and their criteria.
//
// Of several pairs: contact wins over pursuit, pursuit over undecided; escape means that every pair escapes.
// Of more than most_followed_rods rods (separation_record.hpp) only contact is told.

#include "rodwake/core/encounter.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/integrate/ode.hpp"

#include <optional>

namespace rodwake::rods {

/// Ending of the pair (a, b) from the final state and its time derivative; never `contact`.
/// `late` as separation_record.hpp keeps it. In a periodic box of the nearest images (separation.hpp).
Ending classify_pair(integrate::State y, integrate::State ydot, std::size_t a, std::size_t b,
                     const LatePart& late, const EndingCriteria& criteria = {},
                     std::optional<PeriodicBox> box = {});

} // namespace rodwake::rods
