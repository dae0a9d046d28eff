// rodwake replay: frames of a finished bed, made again to the bit from the states that it kept.

#include "definition.hpp"
#include "rodwake/app/replay.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

namespace rodwake::cli {

namespace {

namespace fs = std::filesystem;

} // namespace

int verb_replay(const Options& options) {
    const app::RunContext context = context_of(options);
    if (options.verify) {
        const app::Verified found = app::verify(options.target, context);
        if (found.interrupted)
            return signal_exit_code(stop_signal());
        if (found.differs)
            throw RunError(fmt::format("{}: other bits, first {}", options.target, *found.differs));
        if (!options.quiet)
            fmt::print("{}: {} stretches made again, all to the bit\n", options.target, found.stretches);
        return 0;
    }
    fs::path folder = options.output;
    if (options.output.empty()) { // a folder that the user names may be a link
        const fs::path run = options.target;
        folder = (fs::is_directory(run) ? run : run.parent_path()) / "replay";
        app::refuse_link(folder);
    }
    if (fs::exists(folder / "trajectory.h5md") && !options.force)
        throw InputError(
            fmt::format("{}: already exists; --force replaces it, or name another folder with -o",
                        (folder / "trajectory.h5md").string()));
    const app::Replayed done = app::replay(options.target, options.replay, folder, context);
    if (done.interrupted)
        return signal_exit_code(stop_signal());
    if (!options.quiet)
        fmt::print(
            "{}: {} frames from {:g} to {:g} s, made from the state at {:g} s; state at the end {:016x}\n",
            done.file.string(), done.frames, done.from, done.to, done.begun_at, done.state_hash);
    return 0;
}

} // namespace rodwake::cli
