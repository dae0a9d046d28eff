#pragma once
// medium.field = "measured": where measure.h5 is, and what it holds, in the units of the scene.

#include "rodwake/elastic/measured_field.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>

namespace rodwake::app {

/// Whether fields of the scene or of a variant of it are measured ones that this run makes itself.
bool measures_own_field(const scene::Scene& scene);

/// What theory and measured field are mixed with, and how data are smoothed.
struct MeasuredInput {
    std::filesystem::path file;
    elastic::MeasuredGrid grid;
    elastic::MeasuredOptions options;
};

/// Of medium.measured.file: in the run directory if this scene measures, beside the scene, where the program
/// runs; the first that exists. Throws InputError if there is none, it has no displacement field, or errors
/// are wanted and it knows none.
MeasuredInput read_measured(const scene::Scene& scene, const std::filesystem::path& run_directory);

/// Throws InputError as above for a scene or a variant whose field cannot be read. What the run itself makes
/// is passed over if `made_later`.
void require_measured(const scene::Scene& scene, const std::filesystem::path& run_directory, bool made_later);

} // namespace rodwake::app
