#pragma once
// Rods that nothing turns, on the plane, by their closed form. docs/numerics.md, section 4. In extended
// precision, and where its rounding leaves a contact in doubt with a significand of 113 bits.

#include "rodwake/rods/simulate.hpp"

#include <optional>

namespace rodwake::rods {

/// The ending that the exact motion has; nothing: it may have another within the rounding.
std::optional<Ending> straight_ending(const RodProblem& problem, const EndingCriteria& criteria);

/// When two of them first meet, f/(mu v0); infinite: not by t_end. Looks at all pairs.
double first_meeting(const RodProblem& problem);

} // namespace rodwake::rods
