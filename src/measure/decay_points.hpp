#pragma once
// g_B(r) of a measurement as the fits of its decay take it.

#include "rodwake/measure/structure.hpp"

#include <vector>

namespace rodwake::measure {

/// Where the decay begins to be one: 8 a, where the shells and the 1/r^2 of phonons have faded; at most L/8.
double decay_from(const Layout& layout);

/// g_B(r) from about there on in steps of two lattice rows (less in boxes too small for six such), in smooth
/// windows of four, weighted by pairs: g_B swings with the rows, and whole swings cancel, which needs bins
/// finer than those shown. Neighbouring points share pairs. With each block left out in turn. `bin`: of g(r),
/// m.
DecayPoints decay_points(const std::vector<StructureRecord::Block>& blocks, const Layout& layout, double bin);

} // namespace rodwake::measure
