#pragma once
// psi_6 of each bead with the number of its neighbours, by either rule for who is one.

#include "rodwake/core/bond_order.hpp"

#include <vector>

namespace rodwake::measure {

/// Places in the box, else InputError; 0 < cutoff <= half its shorter side.
LocalOrder order_by_cutoff(const std::vector<double>& x, const std::vector<double>& y, const PeriodicBox& box,
                           double cutoff);
LocalOrder order_by_delaunay(const std::vector<double>& x, const std::vector<double>& y,
                             const PeriodicBox& box);

} // namespace rodwake::measure
