#pragma once
// The explicit Runge-Kutta methods in use, as ARKODE has them.

#include "sundials_raii.hpp"

namespace rodwake::integrate {

/// Dormand-Prince 5(4) for loose tolerances, Verner 6(5) for tight ones, where the higher order pays for its
/// extra stages. Both propagate the higher of their two orders.
enum class Erk { dormand_prince, verner };

/// Its last stage is the first of the next step.
sundials::ButcherTable erk_table(Erk method);

} // namespace rodwake::integrate
