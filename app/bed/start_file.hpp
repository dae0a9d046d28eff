#pragma once
// granular.start_file: the beads of a bed as CSV.

#include "rodwake/granular/problem.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <string>

namespace rodwake::app {

/// Where it is: in the folder of the scene `path`, or where the program runs. Throws InputError if in
/// neither.
std::filesystem::path start_file_of(const scene::Granular& bed, const std::string& path);

/// The beads of the file. Of several kinds without a column kind a bead is of the kind whose radius is
/// nearest to its own. Throws InputError, which names file, line, column and value.
granular::GivenBeads read_start_file(const scene::Granular& bed, const std::string& path);

} // namespace rodwake::app
