#pragma once

#include <optional>
#include <vector>

namespace rodwake::scene {

inline constexpr double max_outputs = 1e6;
inline constexpr double default_outputs = 200.0;

/// i * interval for i = 1, 2, ... below t_end, then t_end exactly. A last gap below 1e-9 interval is merged.
std::vector<double> output_grid(double interval, double t_end);

/// The interval of which `times` is the grid, if it is one.
std::optional<double> grid_interval(const std::vector<double>& times, double t_end);

} // namespace rodwake::scene
