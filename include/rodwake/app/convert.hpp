#pragma once
// Tracks and trajectories from one format into another, by the program convert/rodwake_convert: Python has
// the libraries that know the formats. It works in a process of its own, watched by another: what crashes or
// hangs a library, or takes all memory, ends with a message that names the file.

#include "rodwake/app/run_context.hpp"
#include "rodwake/core/track_rows.hpp"
#include "rodwake/scene/tracks.hpp"
#include "rodwake/store/track_file.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rodwake::app {

struct ConvertRequest {
    /// A file of tracks, a trajectory, or the folder of a run or of an ensemble.
    std::filesystem::path in;
    /// Its ending tells the format; of an ensemble each run gets its number before the ending.
    std::filesystem::path out;
    TrackFormat format = TrackFormat::automatic; ///< of `in`
    std::string frames;          ///< "from:to:stride", numbers of frames from 0, each may be left out
    std::string unit;            ///< of lengths in `out`: "a", "m"; empty: a for beds, else as in the file
    std::string rods;            ///< "poses" or "spheres"; empty: spheres where the file has them, but in CSV
    std::string group;           ///< of H5MD, the particles
    store::TrackColumns columns; ///< names of columns, and which kinds are rods
    bool force = false;          ///< replace `out`
};

/// Names the column of `role`: frame, id, x, y, heading or kind. Throws InputError for any other.
void name_column(ConvertRequest& request, std::string_view role, const std::string& name);

/// Throws InputError for a file that is none of its format, RunError if `out` cannot be written. False after
/// a stop. What is lost on the way, and what the reader noticed, is logged.
bool convert(const ConvertRequest& request, const RunContext& context);

/// The film of tracks.file (or `file`, tracks.rods_file) in the run folder: made once for a file's content
/// and the keys that change how it is read. Empty after a stop.
std::filesystem::path film_of(const scene::Tracks& keys, const std::filesystem::path& file,
                              TrackFormat format, const std::filesystem::path& folder,
                              const RunContext& context, const std::function<void(double)>& on_progress);

/// What its first frames hold, in a line. Throws InputError for what film_of would refuse there.
std::string look_into(const scene::Tracks& keys, const std::filesystem::path& file, TrackFormat format,
                      const RunContext& context);

} // namespace rodwake::app
