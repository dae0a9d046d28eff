#include "granular_task.hpp"

#include "granular_summary.hpp"
#include "measure_records.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/first_difference.hpp"
#include "rodwake/scene/write.hpp"

#include <fmt/format.h>

namespace rodwake::app {

namespace fs = std::filesystem;

namespace {

void require_same_scene(const fs::path& file, const std::string& key) {
    const auto loaded = load_checkpoint(file);
    if (loaded && loaded->checkpoint.scene != key)
        throw InputError(fmt::format(
            "{}: belongs to another scene ({}); choose another folder with -o, or --force to start anew",
            file.string(), first_difference(loaded->checkpoint.scene, key)));
}

} // namespace

std::string granular_key(const scene::Scene& scene) {
    scene::Scene key;
    key.granular = scene.granular;
    key.granular->output.checkpoint = scene::GranularOutput{}.checkpoint;
    key.granular->runs = 1; // an unfinished ensemble may grow
    return scene::to_plain_toml(key);
}

fs::path run_folder(const fs::path& ensemble, std::int64_t run) {
    return ensemble / fmt::format("runs/{:04}", run + 1);
}

std::vector<GranularTask> granular_tasks(const Case& one, const fs::path& directory) {
    const long runs = one.scene.granular->runs;
    const fs::path folder = one.folder.empty() ? directory : directory / one.folder;
    std::vector<GranularTask> tasks;
    for (std::uint32_t run = 0; run < static_cast<std::uint32_t>(runs); ++run)
        tasks.push_back({run, runs == 1 ? folder : run_folder(folder, run)});
    return tasks;
}

namespace {

/// Whether the files are there that cannot be made of the last state. An ensemble that grows may grow out of
/// XYZ.
bool has_files(const GranularPlan& plan, const fs::path& folder, const GranularCheckpoint& last) {
    const GranularSchedule& s = plan.bed.schedule;
    const auto there = [&](bool made, const char* name) { return !made || fs::exists(folder / name); };
    return there(true, "table.csv") && there(!plan.bed.problem.rods.empty(), "tracks.csv") &&
           there(s.h5md, "trajectory.h5md") &&
           there(s.xyz && plan.bed.of.scene.granular->runs == 1, "trajectory.xyz") &&
           there(last.logs.period_frames > 0, "last_period.h5md");
}

/// What was measured on the way, once more from the last state.
void restore_records(const MeasurePlan& plan, const fs::path& file, const GranularCheckpoint& last) {
    if (last.measure_keys != plan.key_text || fs::exists(file))
        return;
    measure::Measures measures = plan.sums;
    measures.load(last.measures, file.string());
    write_records(file, plan, measures);
}

} // namespace

std::optional<GranularSummary> finished_before(const GranularPlan& plan, const GranularTask& task) {
    const auto last = load_checkpoint(task.folder / "final.rwc");
    if (!last || !has_files(plan, task.folder, last->checkpoint))
        return std::nullopt;
    if (plan.bed.measures)
        restore_records(*plan.bed.measures, task.folder / "measure.rwc", last->checkpoint);
    auto known = read_summary(task.folder / "summary.json", plan.bed.problem, task.run);
    const bool whole =
        last->checkpoint.pressure && last->checkpoint.scene == plan.scene_key; // of this version
    return known || !whole ? std::move(known) : std::optional(restore_summary(plan, task));
}

void require_same_run(const GranularTask& task, const std::string& key) {
    for (const char* name : {"checkpoint.rwc", "final.rwc"})
        require_same_scene(task.folder / name, key);
}

GranularResult execute_task(const GranularPlan& plan, const GranularTask& task, const RunContext& context,
                            const Logger& log, std::size_t threads, const OnProgress& on_progress) {
    if (!context.force)
        if (auto known = finished_before(plan, task))
            return {StageEnd::finished, {}, std::move(*known)};
    if (context.stopped())
        return {StageEnd::interrupted, {}, {}};
    return run_granular(plan, task, context, log, threads, on_progress);
}

} // namespace rodwake::app
