#pragma once

#include "rodwake/scene/scene.hpp"

#include <string>

namespace rodwake::scene {

/// The scene as TOML with every default written out, numbers in the scene's own unit system.
/// parse_scene(to_toml(scene), scene.path) == scene, to the last bit: numbers carry up to 17 digits, and one
/// that SI cannot hold exactly is written in reduced units ("2.5 f/mu").
std::string to_toml(const Scene& scene);

/// The same without comments: equal for scenes that mean the same, whatever the documentation says of their
/// keys.
std::string to_plain_toml(const Scene& scene);

} // namespace rodwake::scene
