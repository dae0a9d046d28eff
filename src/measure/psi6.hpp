#pragma once
// psi_6 of each bead with the number of its neighbours, by either rule for who is one.

#include "rodwake/core/bond_order.hpp"

#include <vector>

namespace rodwake::measure {

/// Places in [0, box), else InputError; 0 < cutoff <= box/2.
LocalOrder order_by_cutoff(const std::vector<double>& x, const std::vector<double>& y, double box,
                           double cutoff);
LocalOrder order_by_delaunay(const std::vector<double>& x, const std::vector<double>& y, double box);

} // namespace rodwake::measure
