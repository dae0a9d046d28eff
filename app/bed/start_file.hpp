#pragma once
// granular.start_file: the beads of a bed as CSV.

#include "rodwake/granular/problem.hpp"
#include "rodwake/scene/scene.hpp"

#include <string>

namespace rodwake::app {

/// The beads of the file, found in the folder of the scene `path` or where the program runs. Of several kinds
/// without a column kind a bead is of the kind whose radius is nearest to its own. Throws InputError, which
/// names file, line, column and value.
granular::GivenBeads read_start_file(const scene::Granular& bed, const std::string& path);

} // namespace rodwake::app
