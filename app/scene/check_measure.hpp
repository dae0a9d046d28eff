#pragma once
// What must hold between [measure] and the bed.

#include "rodwake/scene/scene.hpp"

#include <functional>
#include <string>

namespace rodwake::scene {

/// Calls `report` with the path of a key and a message for each contradiction.
void check_measure(const Scene& scene,
                   const std::function<void(const std::string&, const std::string&)>& report);

} // namespace rodwake::scene
