#pragma once

#include "rodwake/scene/scene.hpp"

#include <functional>
#include <string>

namespace rodwake::scene {

/// Reports what does not fit together in [scan]; report(path, message). Whether axes name keys of the scene
/// is seen when they are looked up (compile_setter).
void check_scan(const Scene& scene,
                const std::function<void(const std::string& path, const std::string& message)>& report);

} // namespace rodwake::scene
