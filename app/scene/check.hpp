#pragma once

#include "node.hpp"
#include "problems.hpp"
#include "rodwake/scene/scene.hpp"

namespace rodwake::scene {

/// Reports tables and values that do not fit each other. `root` gives the places. Comparisons of values are
/// left out while `problems` holds any: the values may be stand-ins.
void check(const Scene& scene, const Node& root, Problems& problems);

/// The same for a scene whose values hold and that no document is known of: problems are in scene.path as a
/// whole.
void check(const Scene& scene, Problems& problems);

} // namespace rodwake::scene
