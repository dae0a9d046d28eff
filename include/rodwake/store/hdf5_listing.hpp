#pragma once
// What a result file holds, in words.

#include <filesystem>
#include <string>

namespace rodwake::store {

/// One line for each group (with its attributes) and dataset (with shape and unit). Throws InputError if the
/// file is not HDF5 or cannot be read.
std::string list_hdf5(const std::filesystem::path& path);

} // namespace rodwake::store
