#pragma once

#include "rodwake/scene/scene.hpp"

#include <functional>
#include <string>

namespace rodwake::scene {

/// Reports what a measured or a dynamic [medium] lacks, or what does not fit it, by path and message.
void check_medium(const Scene& scene,
                  const std::function<void(const std::string&, const std::string&)>& report);

} // namespace rodwake::scene
