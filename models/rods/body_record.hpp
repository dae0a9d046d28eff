#pragma once
// Gaps and touches of bodies within a step.

#include "rodwake/rods/separation_record.hpp"

namespace rodwake::rods {

/// What a step adds to the record of rods with bodies, the separations inside it included. Of more than
/// most_followed_rods rods only the end of the step is looked at.
void add_body_step(SeparationRecord& record, const integrate::Step& step, const StateRates& rates, Box box,
                   const BodyForces& bodies);

} // namespace rodwake::rods
