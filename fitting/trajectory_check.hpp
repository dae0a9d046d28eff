#pragma once

#include "rodwake/fitting/trajectory.hpp"

namespace rodwake::fitting {

/// Throws InputError, naming row and trajectory.
void check_trajectories(const std::vector<Trajectory>& trajectories);

/// Throws InputError unless the medium is there and something couples the rods to it.
void check_trajectory_parameters(const std::vector<Parameter>& parameters);

/// A row's origin for messages.
std::string row_name(const Trajectory& trajectory, std::size_t row);

} // namespace rodwake::fitting
