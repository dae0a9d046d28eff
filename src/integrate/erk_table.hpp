#pragma once
// The explicit Runge-Kutta methods in use, as ARKODE has them.

#include "sundials_raii.hpp"

namespace rodwake::integrate {

/// Whether the tolerance asks for the lower order.
inline bool erk_is_loose(double rtol) { return rtol > 1e-7; }

/// Dormand-Prince 5(4) for a loose rtol, else Verner 6(5): the higher order pays for its extra
/// stages. Both propagate the higher of their two orders, and their last stage is the first of the next step.
sundials::ButcherTable erk_table(double rtol);

} // namespace rodwake::integrate
