#pragma once
// The Butcher tables of method erk.

#include "sundials_raii.hpp"

namespace rodwake::integrate {

/// Dormand-Prince 5(4) for rtol > 1e-6, from there down Verner 6(5): the higher order pays for its extra
/// stages. Both propagate the higher of their two orders.
sundials::ButcherTable erk_table(double rtol);

} // namespace rodwake::integrate
