#pragma once
// What is legal in the keys of the order's measure.

#include "rodwake/measure/structure.hpp"

namespace rodwake::measure {

/// Throws InputError for keys outside their domain, a layout that is none, or fewer than 2 beads.
void validate(const Layout& layout, const StructureKeys& keys);

/// Bins of g(r) in one of g_B(r).
std::size_t bins_of_order_bin(const StructureKeys& keys);

} // namespace rodwake::measure
