#pragma once
// Programs that the process starts: Python draws the figures and reads the files of others, so that what
// crashes or hangs a library there ends with a message here.

#include <functional>
#include <string>
#include <vector>

namespace rodwake::app {

struct ChildEnd {
    int code = 0;      ///< exit code; of one that a signal ended 128 + signal
    std::string error; ///< what it wrote to standard error, where that was listened to
};

/// Runs a command (its program is looked for on the PATH) to its end. `on_line` hears every line of its
/// standard output, and standard error is collected; without it the child has the streams of this process.
/// Once `stopped` is true it is sent SIGTERM, as Ctrl-C reaches it anyway. Throws RunError if it cannot be
/// started; `needs` says what is then missing.
ChildEnd run_child(const std::vector<std::string>& command, const std::string& needs,
                   const std::function<bool()>& stopped,
                   const std::function<void(const std::string& line)>& on_line = {});

} // namespace rodwake::app
