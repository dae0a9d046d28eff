#pragma once

#include "options.hpp"
#include "rodwake/scene/scene.hpp"

namespace rodwake::cli {

/// --seed becomes part of the scene, so that the scene.toml of the run makes the same run again. Throws
/// InputError for one that a scene cannot hold.
void take_seed(scene::Scene& scene, const Options& options);

} // namespace rodwake::cli
