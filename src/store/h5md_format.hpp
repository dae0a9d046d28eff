#pragma once
// What an H5MD file calls things, for who writes and who reads one.

#include "hdf5_input.hpp"

#include <string>

namespace rodwake::store {

/// Groups of the bodies.
inline const std::string spheres = "particles/trajectory/", rods = "particles/trajectory_rods/";

enum class H5mdUnit { length, time, mass, speed };

/// What a stored number times gives SI, by the attribute `unit`: 1 where the dataset, or the element whose
/// `value` it is, has no unit. InputError for one that is not known.
double si_factor(const Hdf5Input& file, const std::string& path, H5mdUnit kind);

} // namespace rodwake::store
