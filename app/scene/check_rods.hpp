#pragma once

#include "rodwake/scene/scene.hpp"

#include <functional>
#include <string>

namespace rodwake::scene {

/// Reports values of [rods_random] and [rods_run] that do not fit each other or the medium, by path and
/// message.
void check_rods(const Scene& scene,
                const std::function<void(const std::string&, const std::string&)>& report);

} // namespace rodwake::scene
