#include "rodwake/app/run_folder.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "stage_action.hpp"
#include "stage_kind.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace rodwake::app {

namespace fs = std::filesystem;

namespace {

bool has_files(const fs::path& folder) {
    std::error_code error;
    const fs::directory_iterator entries(folder, error);
    return std::any_of(begin(entries), end(entries), [](const fs::directory_entry& entry) {
        // A run that was killed before its first file was in place, shares of a scan, and what rodwake
        // tradeoff measured are no run's files.
        const std::string name = entry.path().filename().string();
        const bool measured = fs::exists(entry.path().parent_path() / "tradeoff.json") &&
                              (name == "manifest.json" || name == "log.txt" || name == "figures");
        return !(name.starts_with("part-") || name.starts_with("tradeoff") || measured ||
                 (name.starts_with("provenance.json.") && is_temporary(name)) || name == "rodwake.lock");
    });
}

nlohmann::json provenance_of(const fs::path& folder) {
    std::ifstream file(folder / "provenance.json");
    return nlohmann::json::parse(file, nullptr, false);
}

StageRecords records_of(const fs::path& folder) {
    StageRecords records;
    const nlohmann::json json = provenance_of(folder);
    if (json.is_object() && json.contains("stages") && json["stages"].is_object())
        for (const auto& [name, status] : json["stages"].items())
            if (status.is_string())
                records[name] = status;
    return records;
}

std::optional<scene::Scene> scene_of(const fs::path& folder) {
    try {
        return scene::read_scene(folder / "scene.toml");
    } catch (const InputError&) {
        return std::nullopt; // of another version, or never written
    }
}

bool contains(std::span<const Stage> stages, Stage stage) {
    return std::ranges::find(stages, stage) != stages.end();
}

/// In a folder that holds no run yet: an input that bears the name of a result would be replaced.
void refuse_inputs_as_results(const fs::path& folder, const scene::Scene& scene) {
    // The scene and the files it names, wherever they may be.
    std::vector<std::string> names;
    if (scene.fit) {
        for (const auto& item : scene.fit->profiles)
            names.push_back(item.file);
        for (const auto& each : scene.fit->trajectories)
            names.push_back(each.file);
        for (const auto& one : scene.fit->maps)
            names.insert(names.end(), one.files.begin(), one.files.end());
    }
    if (scene.measure)
        names.push_back(scene.measure->trajectory);
    if (scene.granular)
        names.insert(names.end(), {scene.granular->restart_from, scene.granular->start_file});
    if (scene.tracks)
        names.insert(names.end(), {scene.tracks->file, scene.tracks->rods_file});
    if (scene.scan)
        names.push_back(scene.scan->file);
    if (scene.medium && scene.medium->measured)
        names.push_back(scene.medium->measured->file);
    std::vector<fs::path> inputs = {scene.path};
    for (const std::string& name : names)
        if (!name.empty())
            inputs.insert(inputs.end(), {name, fs::path(scene.path).parent_path() / name});

    std::error_code none;
    for (const fs::path& input : inputs) {
        const std::string name = fs::weakly_canonical(input, none)
                                     .lexically_relative(fs::weakly_canonical(folder, none))
                                     .generic_string();
        if (!name.empty() && kind_of(input.filename().string()) && is_own(name) &&
            fs::exists(folder / name, none))
            throw InputError(
                fmt::format("{}: is read by this command, and results of that name would replace it; "
                            "choose another folder with -o, or give the file another name",
                            (folder / name).string()));
    }
}

} // namespace

std::string stage_status(const fs::path& folder, Stage stage) {
    const StageRecords records = records_of(folder);
    const auto record = records.find(to_string(stage));
    if (record == records.end())
        return "";
    const bool lost = record->second == "finished" && lost_files(folder).contains(record->first);
    return lost || record->second == files_lost ? "unfinished" : record->second;
}

std::string run_status(const fs::path& folder) {
    const nlohmann::json json = provenance_of(folder);
    if (!json.is_object() || !json.contains("status") || !json["status"].is_string())
        return {};
    return json["status"];
}

RunFolder::RunFolder(fs::path path, const scene::Scene& scene, std::span<const Stage> stages, bool force,
                     bool reopen_scan, bool draws)
    : path_(std::move(path)), lock_([&] {
          std::error_code error;
          if (fs::exists(path_, error) && !fs::is_directory(path_, error))
              throw InputError(path_.string() + ": is a file; -o names the folder for the results");
          if (!force && run_status(path_).empty() && has_files(path_))
              throw InputError(
                  path_.string() +
                  ": holds files that are not a rodwake run; choose another folder with -o, or --force to "
                  "write among them");
          fs::create_directories(path_, error);
          if (error)
              throw RunError(path_.string() + ": cannot make the folder: " + error.message());
          return FolderLock(path_);
      }()),
      old_(records_of(path_)), anew_(force) {
    had_run_ = !run_status(path_).empty();
    if (had_run_)
        lost_ = lost_files(path_);
    std::erase_if(lost_, [&](const auto& item) {
        const auto record = old_.find(item.first);
        return !item.first.empty() &&
               (record == old_.end() || (record->second != "finished" && record->second != files_lost));
    });
    for (auto& [name, status] : old_)
        if (status == files_lost || lost_.contains(name)) {
            lost_[name];
            status = files_lost;
        }
    if (!run_status(path_).empty() && !provenance_of(path_).contains("stages") && !force)
        throw InputError(path_.string() +
                         ": holds a run of an earlier version of rodwake; choose another folder with -o, or "
                         "--force to replace it");
    if (!had_run_)
        refuse_inputs_as_results(path_, scene);
    const std::optional<scene::Scene> old = scene_of(path_);
    const auto same = [&](Stage stage, bool asked) {
        const auto conflicts = kind_of(stage).conflicts;
        return old && stage_key(*old, stage) == stage_key(scene, stage) &&
               !(conflicts && conflicts(*old, scene, asked));
    };
    const auto difference = [&](Stage stage) {
        const std::string there = stage_key(*old, stage), here = stage_key(scene, stage);
        return there == here ? first_difference(scene::to_plain_toml(*old), scene::to_plain_toml(scene))
                             : first_difference(there, here);
    };
    for (const Stage stage : all_stages()) {
        const StageKind& kind = kind_of(stage);
        const auto record = old_.find(to_string(stage));
        const bool there = record != old_.end();
        StageFacts facts{.asked = contains(stages, stage), .light = kind.light, .force = force};
        if (there)
            facts.record = lost_.contains(record->first)  ? StageRecord::lost
                           : record->second == "finished" ? StageRecord::finished
                                                          : StageRecord::unfinished;
        facts.same_scene = there && same(stage, facts.asked);
        facts.wants_more = there && ((facts.same_scene && kind.grows && kind.grows(*old, scene)) ||
                                     (kind.lacks && kind.lacks(path_, scene)) ||
                                     (facts.same_scene && stage == Stage::scan && reopen_scan));

        const StageAction action = stage_action(facts);
        using enum StageAction;
        if (action == start || action == resume || action == extend || action == restore)
            stages_.push_back(stage);
        if (action == restore)
            restored_.push_back(stage);
        resumed_ = resumed_ || action == resume;
        extended_ = extended_ || action == extend;
        if (action == keep)
            kept_.push_back(stage);
        if (facts.same_scene && action != start)
            unaffected_.insert(*record);
        if (action == refuse)
            throw InputError(fmt::format(
                "{}: holds the stage {} of {}; choose another folder with -o, or --force to replace it",
                path_.string(), record->first,
                old ? fmt::format("another scene ({})", difference(stage)) : "a scene that cannot be read"));
        if (action != drop)
            continue;
        if (stage == Stage::granular) // too dear to go with another stage
            throw InputError(
                fmt::format("{}: holds a granular run of another scene, which this command does not "
                            "replace even with --force; choose another folder with -o",
                            path_.string()));
        if (stage == Stage::rods && contains(stages, Stage::order))
            throw InputError(fmt::format("{}: holds rods of another scene, which this command does not "
                                         "integrate; rodwake rods SCENE does; -o names another folder",
                                         path_.string()));
        dropped_.push_back(stage);
    }
    const auto general = lost_.find("");
    const bool undrawn = draws && had_run_ && !fs::exists(path_ / "report.html"), // which is drawn last
        lacks =
            undrawn || (general != lost_.end() && (draws || !std::ranges::all_of(general->second, is_drawn)));
    if (stages_.empty() && !lacks && !force)
        throw FinishedRun(path_.string() + ": holds a finished run of this scene; choose another folder with "
                                           "-o, or --force to replace it");
    drop_outdated(scene, stages);
    if (old && old->granular && scene.granular && contains(kept_, Stage::granular))
        kept_runs_ = old->granular->runs;
}

void RunFolder::drop_outdated(const scene::Scene& scene, std::span<const Stage> asked) {
    const auto redone = [&](Stage other) { // a fit may have other data by now
        return contains(stages_, other) && (other == Stage::fit || !contains(restored_, other));
    };

    const StageChanges all{redone, [&](Stage other) { return contains(dropped_, other); }};
    for (const Stage stage : std::vector(kept_)) // in the order in which they are done
        if (const auto outdated = kind_of(stage).outdated; outdated && outdated(scene, all)) {
            if (contains(restored_, Stage::fit) && !contains(asked, stage) && !anew_)
                throw InputError(fmt::format(
                    "{}: files of the fit are gone, and {} follows from it: rodwake run SCENE makes "
                    "both again; --force makes the fit and removes {}",
                    path_.string(), to_string(stage), to_string(stage)));
            (contains(asked, stage) ? stages_ : dropped_).push_back(stage);
            std::erase(kept_, stage);
            unaffected_.erase(to_string(stage));
        }
    std::ranges::sort(stages_);
    for (const Stage stage : dropped_)
        unaffected_.erase(to_string(stage));
}

StageRecords RunFolder::records(const std::string& status) const {
    StageRecords records;
    for (const Stage stage : kept_)
        records[to_string(stage)] = old_.at(to_string(stage));
    for (const Stage stage : stages_)
        records[to_string(stage)] = contains(restored_, stage) && status != "finished" ? files_lost : status;
    return records;
}

bool RunFolder::keeps_datasets() const {
    return std::ranges::any_of(kept_, [](Stage stage) { return kind_of(stage).datasets; });
}

void RunFolder::begin(const Provenance& provenance, std::string_view scene) const {
    refuse_links();
    write("provenance.json", provenance(unaffected_));
    remove_outdated();
    write("scene.toml", scene);
    write("provenance.json", provenance(records("unfinished")));
}

void RunFolder::write(std::string_view name, std::string_view content) const {
    const fs::path target = path_ / name;
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    store::write_atomically(target, content);
}

} // namespace rodwake::app
