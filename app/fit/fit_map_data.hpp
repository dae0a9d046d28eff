#pragma once
// The displacement maps that [[fit.maps]] names.

#include "rodwake/app/fit.hpp"

namespace rodwake::app {

/// measure.h5, or a table of a full grid if the name ends in ".csv". Bins without beads, and those of unknown
/// sigma beside others of known, are left out; so is one half of a map that was averaged with its mirror
/// image. Throws InputError naming the file for whatever is missing or wrong.
FitMapData read_fit_map(const scene::FitMap& keys, const std::filesystem::path& file,
                        std::optional<double> independent_spacing, bool needs_speed,
                        const std::string& length_unit);

/// Whether a parameter of the fit goes with the rod's speed.
bool needs_speed(const scene::Fit& keys);

} // namespace rodwake::app
