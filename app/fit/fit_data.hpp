#pragma once
// The measured files that [fit] names: where they are, and what they hold.

#include "rodwake/app/fit.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::app {

/// Where a file of [fit] or [medium.measured] may be, the first that exists counts: the run directory if this
/// scene makes such files, beside the scene, where the program runs. `run_directory` empty: there is none
/// yet.
std::vector<std::filesystem::path> data_file_places(const std::string& file, const scene::Scene& scene,
                                                    const std::filesystem::path& run_directory);

/// Throws InputError naming all places if it is in none of them, or is there and no regular file.
std::filesystem::path find_fit_file(const std::string& file, const scene::Scene& scene,
                                    const std::filesystem::path& run_directory);

/// Whether the run itself may make the file before it is fitted.
bool made_by_run(const std::string& file, const scene::Scene& scene);

/// Throws InputError with file:line for a wrong header, a number that is not finite, sigma <= 0, no points.
FitProfileData read_fit_profile(const scene::FitProfile& keys, const std::filesystem::path& file,
                                std::optional<double> independent_spacing);

/// Rows before t = 0, when rods of a bed are still held, are left out. Each heading is brought within half a
/// turn of the row before: files give them modulo 2 pi, or as one angle of many. Throws InputError as above.
FitTrackData read_fit_track(const scene::FitTrajectory& keys, const std::filesystem::path& file,
                            std::optional<PeriodicBox> box = {}, const rods::RodBodies& bodies = {});

/// f/(zeta v), from the measure.json of a run that such a map is of: the box's area times the drift of the
/// bed over the speed of the rod, as the force of the rod is the drag on the whole bed. Throws InputError
/// naming what is missing.
Estimate read_drag_area(const std::filesystem::path& run_directory, const fitting::Map& map);

/// The maps of a file: measure.h5, of all runs together or, where it has them, of each; or a table of a full
/// grid if the name ends in ".csv". Bins without beads, and those of unknown
/// sigma beside others of known, are left out; so is one half of a map that was averaged with its mirror
/// image. Throws InputError naming the file for whatever is missing or wrong.
std::vector<FitMapData> read_fit_maps(const scene::FitMap& keys, const std::filesystem::path& file,
                                      std::optional<double> independent_spacing, bool needs_speed,
                                      const std::string& length_unit);

/// Whether a parameter of the fit goes with the rod's speed.
bool needs_speed(const scene::Fit& keys);

} // namespace rodwake::app
