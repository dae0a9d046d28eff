#pragma once
// What must hold within [fit], and between it and the medium.

#include "rodwake/scene/scene.hpp"

#include <functional>
#include <string>

namespace rodwake::scene {

/// Calls `report` with the path of a key and a message for each contradiction.
void check_fit(const Scene& scene, const std::function<void(const std::string&, const std::string&)>& report);

} // namespace rodwake::scene
