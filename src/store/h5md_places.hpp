#pragma once
// Where bodies stand in an H5MD file, for who writes and who reads one.

#include <string>

namespace rodwake::store {

inline const std::string spheres = "particles/trajectory/", rods = "particles/trajectory_rods/";

} // namespace rodwake::store
