#pragma once
// Attributes `unit` of H5MD: what a stored number times gives SI.

#include "hdf5_input.hpp"

namespace rodwake::store {

enum class H5mdUnit { length, time, mass, speed };

/// 1 where the dataset, or the element whose `value` it is, has no unit. InputError for one that is not
/// known.
double si_factor(const Hdf5Input& file, const std::string& path, H5mdUnit kind);

} // namespace rodwake::store
