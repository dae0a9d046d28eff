#pragma once
// A run directory: where one command's results go. provenance.json tells whether it is finished.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace rodwake::store {

/// Who made a result, and how to make it again.
struct Provenance {
    std::string command; ///< as typed
    std::string scene;   ///< file the scene came from
    std::string status;  ///< "unfinished" | "finished" | "interrupted" | "failed"
    std::uint64_t seed = 0;
    double wall_seconds = 0.0;
};

/// JSON with the above, rodwake's version and git id, library versions, compiler, CPU, date (UTC).
std::string provenance_json(const Provenance& provenance);

class RunDirectory {
public:
    /// Makes the folder, or takes over one that holds an unfinished run. Throws InputError if it holds a
    /// finished run or foreign files and `force` is not set, RunError if it cannot be written.
    RunDirectory(std::filesystem::path path, bool force);

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path file(std::string_view name) const { return path_ / name; }
    /// True if an earlier run was left unfinished here and is taken up; with `force` it is replaced.
    bool resumed() const { return resumed_; }

    /// Marks the folder as this run's, before anything else is written; then removes the results of an
    /// earlier run, and if that is not taken up, its granular checkpoints, logs and everything of its own
    /// in runs/ too. Throws RunError.
    void begin(std::string_view provenance) const;

    /// Writes a file atomically. Throws RunError.
    void write(std::string_view name, std::string_view content) const;

private:
    std::filesystem::path path_;
    bool resumed_ = false, had_run_ = false;
};

/// "finished", "unfinished", ... of the run in a folder; empty if there is none.
std::string run_status(const std::filesystem::path& folder);

} // namespace rodwake::store
