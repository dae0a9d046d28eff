#pragma once
// Values of empty bins from those around them.

#include <cstddef>
#include <vector>

namespace rodwake::measure {

/// Solves the discrete Laplace equation in the bins of an n x n grid that are not known, with the known ones
/// as given and no flux through the edge. All stay as they are if none is known.
void fill_in(std::vector<double>& values, const std::vector<bool>& known, std::size_t n);

} // namespace rodwake::measure
