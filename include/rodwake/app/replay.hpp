#pragma once
// Frames of a finished bed, made again to the bit from the states that it kept (granular.output.archive), or
// from its start.

#include "rodwake/app/run_context.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace rodwake::app {

struct ReplayRequest {
    double from = 0.0;              ///< s, from the end of the equilibration
    std::optional<double> to;       ///< s; absent: to the end of the run
    std::optional<double> interval; ///< of the frames, s; absent: that of the run
};

struct Replayed {
    bool interrupted = false;
    std::size_t frames = 0;
    double from = 0.0, to = 0.0;  ///< of the first and the last frame, s
    double begun_at = 0.0;        ///< of the state from which it was made, s
    std::uint64_t state_hash = 0; ///< of the last frame's state
    std::filesystem::path file;
};

/// Writes trajectory.h5md into `folder`. `run`: the folder of a finished run, or an archive.rwc. Throws
/// InputError for times outside of the run and for what is no finished run; RunError.
Replayed replay(const std::filesystem::path& run, const ReplayRequest& request,
                const std::filesystem::path& folder, const RunContext& context);

struct Verified {
    bool interrupted = false;
    std::size_t stretches = 0;          ///< between two kept states, made again
    std::optional<std::string> differs; ///< where bits first differ, in words
};

/// Makes a whole run again, from each state that it kept to the next one, on all threads.
Verified verify(const std::filesystem::path& run, const RunContext& context);

} // namespace rodwake::app
