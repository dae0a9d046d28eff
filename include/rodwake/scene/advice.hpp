#pragma once
// What is legal in a scene and yet hardly meant.

#include "rodwake/scene/scene.hpp"

#include <string>
#include <vector>

namespace rodwake::scene {

/// One sentence each: headings and other angles beyond one turn, which were most likely meant in degrees.
std::vector<std::string> advice(const Scene& scene);

} // namespace rodwake::scene
