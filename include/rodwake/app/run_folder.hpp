#pragma once
// The folder of a run: which stages it holds, of which scene, and who may work on it. provenance.json tells
// how each stage ended, scene.toml which scene they are of.
//
// A command adds its stages to those that the folder holds of the same scene, and goes on with those that did
// not finish, or of which files are gone. What it would destroy it refuses: stages of another scene, stages
// that are finished, files that are not a run's; `force` replaces them. One process at a time: a lock names
// its host and process, one whose process has ended is taken over.

#include "rodwake/app/plan.hpp"
#include "rodwake/app/run_context.hpp"
#include "rodwake/core/error.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::app {

struct FileKind;

/// "unfinished" | "finished" | "interrupted" | "failed" | files_lost of each stage a run holds, by its name.
using StageRecords = std::map<std::string, std::string>;
/// Of a stage that was finished, until its files are there again: what follows from it stays.
inline constexpr const char* files_lost = "files lost";

/// Files that the manifest lists and that are gone, by the stage that made them; of none: of the run as a
/// whole and what is drawn.
using LostFiles = std::map<std::string, std::vector<std::string>>;
LostFiles lost_files(const std::filesystem::path& folder);

/// "finished", "unfinished", ... of the run in a folder: the worst of its stages; empty if there is none.
std::string run_status(const std::filesystem::path& folder);

/// The same of one stage: finished if its files are there, too.
std::string stage_status(const std::filesystem::path& folder, Stage stage);

/// What the results of a stage depend on, as text: scenes of the same text have the same results of it.
std::string stage_key(const scene::Scene& scene, Stage stage);

/// Throws InputError for a link: what it leads to is not the run's, so nothing is written through it.
void refuse_link(const std::filesystem::path& path);

/// Holds `rodwake.lock` of a folder until it goes.
class FolderLock {
public:
    /// Throws InputError naming host and process if another one works in the folder; `taken_over` says whose
    /// lock was left behind, empty if none.
    explicit FolderLock(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(FolderLock&& other) noexcept;
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;
    FolderLock& operator=(FolderLock&&) = delete;

    const std::string& taken_over() const { return taken_over_; }
    /// Why the lock may not hold, for the user; empty if it does.
    const std::string& doubt() const { return doubt_; }

private:
    std::string name_;
    int file_ = -1;
    std::string taken_over_, doubt_;
};

/// The folder holds all that is asked for, so there is nothing to do.
class FinishedRun : public InputError {
public:
    using InputError::InputError;
};

class RunFolder {
public:
    /// Makes the folder, or takes up the run in it. Throws InputError for a folder that cannot be used
    /// (above), FinishedRun for one in which nothing is left to do, RunError if it cannot be written. Nothing
    /// of an earlier run is touched yet. `reopen_scan`: a scan goes on though it is finished; `draws`:
    /// figures that are gone are reason enough.
    RunFolder(std::filesystem::path path, const scene::Scene& scene, std::span<const Stage> stages,
              bool force, bool reopen_scan = false, bool draws = false);

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path file(std::string_view name) const { return path_ / name; }
    /// Stages that are to be done: of those that were asked for, the ones that are not finished.
    const std::vector<Stage>& stages() const { return stages_; }
    /// Stages that an earlier command finished and this one keeps.
    const std::vector<Stage>& kept() const { return kept_; }
    /// Runs of the granular ensemble that is kept, whatever the scene asks for now.
    const std::optional<long>& kept_runs() const { return kept_runs_; }
    /// True if a stage that was left unfinished is taken up.
    bool resumed() const { return resumed_; }
    /// True if a stage that was finished goes on: more runs, a finer scan.
    bool extended() const { return extended_; }
    /// Of stages that were finished.
    const LostFiles& lost() const { return lost_; }
    const FolderLock& lock() const { return lock_; }

    /// How each stage stands with the stages that are to be done at `status`.
    StageRecords records(const std::string& status) const;

    /// Whether result.h5 holds datasets of a stage that is kept.
    bool keeps_datasets() const;

    /// provenance.json of a folder whose stages stand like this.
    using Provenance = std::function<std::string(const StageRecords&)>;

    /// Marks the folder as this run's, before anything else is written; then removes what earlier commands
    /// left of the stages that are to be done, but for what they go on from; writes scene.toml; records the
    /// stages as unfinished. Until the new scene is in place the records are of stages only to which it makes
    /// no difference, so whoever is killed in between leaves a folder that can be taken up. Throws RunError.
    void begin(const Provenance& provenance, std::string_view scene) const;

    /// Writes a file atomically. Throws RunError.
    void write(std::string_view name, std::string_view content) const;

private:
    /// Stages that follow from one that is done again: done again too if asked for, else dropped.
    void drop_outdated(const scene::Scene& scene, std::span<const Stage> asked);
    void refuse_links() const;
    /// Files of stages that are done again or dropped, and what killed runs left half written.
    void remove_outdated() const;
    bool is_outdated(const FileKind& kind, const std::string& name) const;
    /// Only files that were gone are made again, of the same content.
    bool only_restores() const { return stages_.size() == restored_.size() && dropped_.empty(); }

    std::filesystem::path path_;
    FolderLock lock_;
    StageRecords old_;
    LostFiles lost_;
    StageRecords unaffected_; ///< those of old_ that are of the old and of the new scene
    std::vector<Stage> stages_, kept_, dropped_;
    std::vector<Stage> restored_; ///< those of stages_ that were finished, but for lost files
    std::optional<long> kept_runs_;
    bool resumed_ = false, extended_ = false, anew_ = false, had_run_ = false;
};

} // namespace rodwake::app
