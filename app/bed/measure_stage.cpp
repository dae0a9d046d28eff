#include "measure_stage.hpp"

#include "bed/measure_kind.hpp"
#include "film_rods.hpp"
#include "granular_jobs.hpp"
#include "granular_summary.hpp"
#include "measure_frames.hpp"
#include "measured_tracks.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/scene/read.hpp"
#include "run/log.hpp"
#include "run/record_table.hpp"
#include "run/stage_kind.hpp"
#include "run_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_unrecorded(const fs::path& run) {
    throw InputError(run.string() + ": this run recorded nothing for these [measure] keys, and it stored no "
                                    "trajectory (granular.output.formats without \"h5md\"); run it again");
}

/// Whether frames are made again: of a run with an archive that stored none, or none that fit.
bool replays(const RunFiles& run, const MeasurePlan& plan) {
    if (!fs::exists(run.folder / "archive.rwc"))
        return false;
    if (!fs::exists(run.trajectory))
        return true;
    try {
        check_trajectory(run.trajectory, plan);
        return false;
    } catch (const InputError&) {
        return true;
    }
}

/// Of all runs; nothing if a signal stopped it.
std::optional<std::vector<measure::Measures>> sums_of(const std::vector<RunFiles>& runs,
                                                      const MeasurePlan& plan, const RunContext& context) {
    SharedProgress progress(context, "measure", runs.size(), static_cast<double>(runs.size()), "runs");
    std::vector<std::optional<measure::Measures>> found(runs.size());
    parallel_for(runs.size(), context.thread_count(), [&](std::size_t i) {
        // The sums that the run recorded are used if they belong to these keys, else its frames are measured
        // now.
        const RunFiles& run = runs[i];
        const auto on_progress = [&](double part) {
            progress.update(i, part);
            return !context.stopped();
        };
        if (run.own)
            found[i] = read_records(run.folder / "measure.rwc", plan);
        if (found[i])
            return;
        if (run.own && replays(run, plan)) {
            found[i] = measure_archive(run.folder / "archive.rwc", plan, on_progress);
            return;
        }
        if (run.own && !fs::exists(run.trajectory))
            refuse_unrecorded(run.folder);
        found[i] = measure_trajectory(run.trajectory, plan, on_progress);
    });
    std::vector<measure::Measures> all;
    for (auto& item : found)
        if (item)
            all.push_back(std::move(*item));
    return all.size() == found.size() ? std::optional(std::move(all)) : std::nullopt;
}

/// Names of the kinds for which this holds.
template<class Holds>
std::string names_where(const Holds& holds) {
    std::vector<std::string_view> names;
    for (const MeasureKind& kind : measure_kinds())
        if (holds(kind))
            names.push_back(kind.name);
    return fmt::format("{}", fmt::join(names, ", "));
}

std::vector<RunFiles> finished(std::span<const GranularTask> tasks) {
    std::vector<RunFiles> found;
    for (const GranularTask& task : tasks)
        if (fs::exists(task.folder / "summary.json"))
            found.push_back({task.folder, task.folder / "trajectory.h5md", true});
    return found;
}

/// Nothing if a signal stopped it.
std::optional<CaseResults> measure_case(const BedPlan& bed, const RunContext& context, const fs::path& folder,
                                        const Logger& log) {
    const Case& case_ = bed.of;
    const std::vector<RunFiles> runs = finished_runs(case_, folder, log);
    const scene::Measure& m = *case_.scene.measure;
    const scene::Granular& keys = *case_.scene.granular;
    CaseResults results;
    results.label = case_.label;
    results.folder = case_.folder;
    SeriesRow& row = results.row;
    row.name = case_.name;
    row.bead_radius = keys.bead_radius;
    row.phi_b = phi_b(bed);
    row.runs = runs.size();
    if (keys.rods.size() == 2) {
        const auto &p = keys.rods[0].position, &q = keys.rods[1].position;
        row.separation = nearest_distance(p[0] - q[0], p[1] - q[1], bed.problem.box);
    }
    if (!keys.rods.empty())
        row.imposed_speed = keys.rods[static_cast<std::size_t>(m.rod)].imposed_speed;
    std::vector<measure::Measures> sums;
    if (bed.measures) {
        auto found = sums_of(runs, *bed.measures, context);
        if (!found)
            return std::nullopt;
        sums = std::move(*found);
    }
    std::vector<RunTables> tables;
    for (const RunFiles& run : runs)
        if (run.own)
            tables.push_back(run_tables(run.folder));
    const MeasuredCase data{case_.scene, sums, tables, results.row};
    const auto lacks_tables = [&](const MeasureKind& kind) {
        return kind.wanted(m) && !kind.include && data.tables.empty();
    };
    if (const std::string lacking = names_where(lacks_tables); !lacking.empty())
        log->warn("measure: made from a run's own tables, and so left out with measure.trajectory: {}",
                  lacking);
    report_measures(data, results);
    return results;
}

} // namespace

void report_measures(const MeasuredCase& data, CaseResults& results) {
    for (const MeasureKind& kind : measure_kinds()) {
        if (!kind.wanted(*data.scene.measure) || !(kind.include || !data.tables.empty()))
            continue;
        // One measure that cannot be had does not take the others with it: its reason is kept.
        try {
            // Runs that recorded on their way may have ended before the first frame.
            const auto empty = [](const measure::Measures& run) { return run.frames() == 0; };
            if (kind.include && std::ranges::all_of(data.sums, empty))
                throw InputError(why_no_frames(data.sums.front()));
            results.reports.emplace_back(kind.name, kind.report(data));
        } catch (const InputError& error) {
            results.not_measured.emplace_back(kind.name, error.what());
        } catch (const RunError& error) {
            results.not_measured.emplace_back(kind.name, error.what());
        }
    }
}

std::vector<RunFiles> finished_runs(const Case& case_, const fs::path& folder, const Logger& log) {
    const std::string foreign = case_.scene.measure ? case_.scene.measure->trajectory : "";
    if (!foreign.empty())
        return {{fs::path(foreign).parent_path(), foreign, false}};
    const std::vector<GranularTask> tasks = granular_tasks(case_, folder);
    std::vector<RunFiles> found = finished(tasks);
    if (found.empty())
        throw InputError(
            (folder / case_.folder).string() +
            ": holds no finished granular run to measure; rodwake dem SCENE -o DIR makes one, rodwake run "
            "does both; or name a file in measure.trajectory");
    if (found.size() < tasks.size())
        log->warn("measure: {} of {} runs are finished; the others are left out", found.size(), tasks.size());
    return found;
}

namespace {

void require_measurable(const Plan& plan, const fs::path& folder, const RunContext& context) {
    if (plan.scene.tracks) {
        look_at_tracks(plan.scene, nullptr);
        return;
    }
    const std::string& trajectory = plan.scene.measure->trajectory;
    if (!trajectory.empty()) {
        const auto& frames = plan.beds.front().measures;
        if (!frames)
            throw InputError(plan.scene.path +
                             ": measure.trajectory is given, but nothing that is measured in frames: " +
                             names_where([](const MeasureKind& kind) { return kind.include; }));
        return check_trajectory(trajectory, *frames);
    }
    if (!only_measures(plan))
        return;
    require_run(plan, folder);
    if (!context.force && stage_status(folder, Stage::measure) != "unfinished")
        return;
    // Finished runs of the folder hold what is to be measured: seen before an earlier measurement makes room.
    for (const BedPlan& bed : plan.beds) {
        if (!bed.measures)
            continue;
        for (const RunFiles& run : finished(granular_tasks(bed.of, folder))) {
            if (read_records(run.folder / "measure.rwc", *bed.measures) || replays(run, *bed.measures))
                continue;
            if (!fs::exists(run.trajectory))
                refuse_unrecorded(run.folder);
            check_trajectory(run.trajectory, *bed.measures);
        }
    }
}

} // namespace

StageEnd measure_folder(const Plan& plan, const RunContext& context, const fs::path& folder,
                        const Logger& log) {
    const auto& bed_table = plan.scene.granular;
    const MeasureOrigin origin{context.command, bed_table ? static_cast<std::uint64_t>(bed_table->seed) : 0};
    std::vector<CaseResults> all;
    StageEnd end = StageEnd::finished;
    const auto take = [&](const Case& case_, std::optional<CaseResults> results) {
        if (!results)
            return false;
        fs::create_directories(folder / case_.folder);
        write_measures(folder / case_.folder, *results, origin);
        for (const auto& [name, reason] : results->not_measured) {
            log->error("measure{}: {}: {}", case_.suffix(), name, reason);
            end = StageEnd::failed;
        }
        for (const std::string& line : describe(*results))
            log->info("{}", line);
        all.push_back(std::move(*results));
        return true;
    };
    if (plan.scene.tracks) {
        const Case item{"scene", "", "", plan.scene};
        return take(item, measure_tracks(item, context, folder, log)) ? end : StageEnd::interrupted;
    }
    for (const BedPlan& bed : plan.beds)
        if (!take(bed.of, measure_case(bed, context, folder, log)))
            return StageEnd::interrupted;
    if (all.size() > 1)
        write_series(folder, all);
    return end;
}

namespace {

std::vector<ColumnInfo> measured_numbers() {
    std::vector<ColumnInfo> numbers = {
        {"units.a", "m", "the bead radius"},
        {"phi_b", "1", "area fraction requested in the scene: of beads, and of rods where they count"}};
    const auto add = [&](const MeasureKind& kind, std::span<const ColumnInfo> values) {
        for (const ColumnInfo& value : values)
            if (!value.unit.empty())
                numbers.push_back(
                    column_info(fmt::format("{}.{}", kind.name, value.name), value.unit, value.meaning));
    };
    for (const MeasureKind& kind : measure_kinds())
        if (kind.film_numbers)
            add(kind, kind.film_numbers());
    for (const MeasureKind& kind : measure_kinds())
        add(kind, kind.values());
    return numbers;
}

/// measure.h5: the group of a measure and the name of the layer.
std::vector<ColumnInfo> measured_layers() {
    std::vector<ColumnInfo> layers;
    for (const MeasureKind& kind : measure_kinds())
        if (kind.layers)
            for (const ColumnInfo& layer : kind.layers())
                layers.push_back(
                    column_info(fmt::format("{}/{}", kind.name, layer.name), layer.unit, layer.meaning));
    return layers;
}

std::vector<FileKind> measure_result_files() {
    static const std::vector<ColumnInfo> measured = measured_numbers(), layers = measured_layers();
    std::vector<FileKind> files = {
        {"measure.h5", Lifetime::result, "fields on grids in the rod's frame, as a group for each measure",
         layers},
        {"series.json", Lifetime::result, "fits over the rows of series.csv"},
        {"measure.json", Lifetime::result,
         "every measured number with its error; lengths in a, speeds in a/s", measured},
        {"series.csv", Lifetime::result, "one row for the scene and one for each variant",
         columns_of<SeriesRow>()},
        {"rod_tracks.csv", Lifetime::result, "poses of the rods of a film in every frame",
         film_rod_columns()},
        {"film_frame.csv", Lifetime::result, "beads of the frame of a film that has most of them",
         film_frame_columns()},
        {"tracks.json", Lifetime::result, "contents of the file of tracks, and what was left out",
         tracks_values()}};
    for (const MeasureKind& kind : measure_kinds())
        if (kind.files)
            std::ranges::move(kind.files(), std::back_inserter(files));
    return files;
}

} // namespace

StageKind measure_stage() {
    return {
        .stage = Stage::measure,
        .has_table = [](const scene::Scene& s) { return s.measure.has_value(); },
        .wanted =
            [](const scene::Scene& s) { return s.measure && scan_subject(s) != scene::ScanSubject::beds; },
        .key =
            [](const scene::Scene& s) {
                if (s.tracks) {
                    scene::Scene key;
                    key.tracks = s.tracks;
                    key.measure = s.measure;
                    return scene::to_plain_toml(key);
                }
                return key_of_beds(
                    s, [](scene::Scene& key, const scene::Scene& of) { key.measure = of.measure; });
            },
        .files = measure_result_files,
        .read =
            [](PlanInputs& inputs, const scene::Scene& s, const InputRequest& request) {
                if (request.check && s.tracks)
                    inputs.tracks = look_at_tracks(s, &request.context);
            },
        .run =
            [](Session& session) {
                return measure_folder(session.plan, session.context, session.directory.path(), session.log);
            },
        .require = require_measurable,
        .cost =
            [](const Plan& plan, const fs::path&, const RunContext&) {
                return std::string(plan.has(Stage::granular)
                                       ? ""
                                       : "  measures: about as long as reading the trajectory takes\n");
            },
        .outdated = [](const scene::Scene&, const StageChanges& all) { return all.redone(Stage::granular); },
        .light = true};
}

} // namespace rodwake::app
