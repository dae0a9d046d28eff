#pragma once
// The measured files that [fit] names: where they are, and what they hold.

#include "rodwake/fitting/trajectory.hpp"
#include "rodwake/fitting/wake.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace rodwake::cli {

/// Where a file of [fit] may be, the first that exists counts: the run directory if this scene makes files to
/// fit, beside the scene, where the program runs. `run_directory` empty: there is none yet.
std::vector<std::filesystem::path> fit_file_places(const std::string& file, const scene::Scene& scene,
                                                   const std::filesystem::path& run_directory);

/// Throws InputError naming all places if it is in none of them, or is there and no regular file.
std::filesystem::path find_fit_file(const std::string& file, const scene::Scene& scene,
                                    const std::filesystem::path& run_directory);

/// Whether the run itself may make the file before it is fitted.
bool made_by_run(const std::string& file, const scene::Scene& scene);

struct FitProfileData {
    std::string name;
    std::filesystem::path file;
    fitting::Profile data;
    std::size_t left_out = 0; ///< points of unknown sigma beside others of known
};

/// Throws InputError with file:line for a wrong header, a number that is not finite, sigma <= 0, no points.
FitProfileData read_fit_profile(const scene::FitProfile& keys, const std::filesystem::path& file,
                                std::optional<double> independent_spacing);

struct FitTrackData {
    std::string name;
    std::filesystem::path file;
    std::size_t rods = 0;
    double length = 1.0, time = 1.0; ///< what a reduced unit is in the file's numbers
    bool sigma_known = false;
    bool unwrapped = false; ///< headings that jumped by turns were brought near those of the row before
    fitting::Trajectory data;
};

/// Rows before t = 0, when rods of a bed are still held, are left out. Each heading is brought within half a
/// turn of the row before: files give them modulo 2 pi, or as one angle of many. Throws InputError as above.
FitTrackData read_fit_track(const scene::FitTrajectory& keys, const std::filesystem::path& file);

} // namespace rodwake::cli
