#pragma once
// The part of a trajectory that is the same in every frame, read and checked.

#include "rodwake/store/h5md_reader.hpp"

#include "hdf5_input.hpp"

namespace rodwake::store {

/// Throws InputError.
TrajectoryInfo read_trajectory_info(const Hdf5Input& file);

} // namespace rodwake::store
