#pragma once

#include "rodwake/scene/scene.hpp"

#include <functional>
#include <string>

namespace rodwake::scene {

/// Reports values of [granular] that do not fit each other, by path and message.
/// What needs the geometry of rods (does it fit?) is left to granular::validate.
void check_granular(const Scene& scene,
                    const std::function<void(const std::string&, const std::string&)>& report);

} // namespace rodwake::scene
