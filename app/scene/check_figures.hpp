#pragma once

#include "rodwake/scene/scene.hpp"

#include <functional>
#include <string>

namespace rodwake::scene {

/// Reports, by path and message, figures whose scene lacks what they show, and keys that mean nothing for
/// their kind.
void check_figures(const Scene& scene,
                   const std::function<void(const std::string&, const std::string&)>& report);

} // namespace rodwake::scene
