#include "granular_jobs.hpp"

#include "granular_files.hpp"
#include "granular_summary.hpp"
#include "measure_frames.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "start_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>

namespace rodwake::app {

namespace {

/// Jobs as points of an executor, whose ids are positions in the list. What a job throws is kept in `thrown`.
scan::Evaluate evaluate_jobs(const std::vector<GranularJob>& jobs, const RunContext& context,
                             const Logger& log, std::size_t threads, const OnJob& on_job,
                             std::vector<std::exception_ptr>& thrown) {
    return [&, threads](std::span<const scan::Point> points, std::span<scan::Result> results) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto start = std::chrono::steady_clock::now();
            const auto number = static_cast<std::size_t>(points[i].id);
            const GranularJob& job = jobs[number];
            scan::Result& result = results[i];
            result.point = points[i];
            try {
                job.result() = execute_task(job.of->plan, job.its(), context, log, threads,
                                            [&](const granular::Simulation& s,
                                                const granular::TableRow* row) { on_job(number, &s, row); });
                result.status = job.result().end == StageEnd::finished ? scan::Status::ok
                                : job.result().end == StageEnd::failed ? scan::Status::failed
                                                                       : scan::Status::stopped;
                result.set_cause(job.result().message);
            } catch (const std::exception& error) {
                thrown[number] = std::current_exception();
                result.status = scan::Status::exception;
                result.set_cause(rodwake::describe(error));
            }
            result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        }
    };
}

} // namespace

LoadedCheckpoint stored_checkpoint(const std::string& file) {
    auto loaded = load_checkpoint(file);
    if (!loaded)
        throw InputError(file + ": no such checkpoint (granular.restart_from); a finished run keeps its last "
                                "state in final.rwc, an unfinished one in checkpoint.rwc");
    return std::move(*loaded);
}

std::vector<BedWork> beds_of(const Plan& plan, const std::filesystem::path& folder, const Logger& log) {
    std::vector<BedWork> all;
    for (const BedPlan& bed : plan.beds) {
        BedWork work{{bed, granular_key(bed.of.scene), {}}, granular_tasks(bed.of, folder), {}};
        const scene::Granular& keys = *bed.of.scene.granular;
        if (keys.start == scene::GranularStart::restart) {
            LoadedCheckpoint loaded = stored_checkpoint(keys.restart_from);
            if (!loaded.notice.empty())
                log->warn("{}", loaded.notice);
            work.plan.restart = std::move(loaded.checkpoint.state);
        }
        if (const auto& from = work.plan.restart; from && from->beads.size() > bed.problem.beads)
            log->info("dem{}: {} of the {} beads of {} are taken out", bed.of.suffix(),
                      from->beads.size() - bed.problem.beads, from->beads.size(), keys.restart_from);
        work.results.resize(work.tasks.size(), {StageEnd::interrupted, {}, {}});
        all.push_back(std::move(work));
    }
    return all;
}

std::vector<GranularJob> jobs_of(std::vector<BedWork>& beds) {
    std::vector<GranularJob> jobs;
    for (BedWork& work : beds)
        for (std::size_t i = 0; i < work.tasks.size(); ++i)
            jobs.push_back({&work, i});
    std::ranges::stable_sort(jobs, std::ranges::greater(),
                             [](const GranularJob& job) { return sphere_steps(job.of->plan.bed.problem); });
    return jobs;
}

double simulated_seconds(const GranularPlan& plan) {
    const granular::GranularProblem& p = plan.bed.problem;
    return static_cast<double>(p.steps + p.equilibration_steps) * p.time_step;
}

void execute_jobs(const std::vector<GranularJob>& jobs, const RunContext& context, const Logger& log,
                  const OnJob& on_job) {
    // a single run has all threads; of several each has one, and a rank computes on one
    const std::size_t threads = context.executor ? 1 : context.thread_count();
    std::vector<std::exception_ptr> thrown(jobs.size());
    const scan::Evaluate evaluate =
        evaluate_jobs(jobs, context, log, jobs.size() == 1 ? threads : 1, on_job, thrown);
    const scan::Execute execute = context.executor ? context.executor(evaluate, context.stop)
                                                   : scan::on_threads(evaluate, threads, context.stop);
    // Runs that an earlier command finished are not made again.
    std::vector<scan::Point> unfinished;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        auto known = context.force ? std::nullopt : finished_before(jobs[i].of->plan, jobs[i].its());
        if (known)
            jobs[i].result() = {StageEnd::finished, {}, std::move(*known)};
        else
            unfinished.push_back({static_cast<std::int64_t>(i), {}});
    }
    // Another rank leaves its summary in the folder of the run. What a job threw does not stop the others.
    execute(unfinished, [&](std::span<const scan::Result> results) {
        for (const scan::Result& result : results) {
            const auto number = static_cast<std::size_t>(result.point.id);
            const GranularJob& job = jobs[number];
            if (job.result().end != StageEnd::interrupted || thrown[number])
                continue;
            if (result.status == scan::Status::exception) {
                thrown[number] = std::make_exception_ptr(
                    RunError(fmt::format("{}: {}", job.its().folder.string(), result.cause_text())));
                continue;
            }
            job.result() = {StageEnd::failed, std::string(result.cause_text()), {}};
            if (result.ok()) {
                const std::filesystem::path file = job.its().folder / "summary.json";
                auto summary = read_summary(file, job.of->plan.bed.problem, job.its().run);
                if (!summary)
                    throw RunError(file.string() + ": another rank finished this run, and its summary is not "
                                                   "there: the ranks must share the folder");
                job.result() = {StageEnd::finished, {}, std::move(*summary)};
            }
            on_job(number, nullptr, nullptr);
        }
    });
    for (const std::exception_ptr& item : thrown)
        if (item)
            std::rethrow_exception(item);
}

void serve_beds(const Plan& plan, const std::filesystem::path& folder, const RunContext& context,
                scan::MpiJob& job) {
    const Logger log = make_silent_logger();
    std::vector<BedWork> beds = beds_of(plan, folder, log);
    const std::vector<GranularJob> jobs = jobs_of(beds);
    std::vector<std::exception_ptr> thrown(jobs.size());
    const OnJob nobody = [](auto&&...) {};
    job.serve(evaluate_jobs(jobs, context, log, 1, nobody, thrown));
}

namespace fs = std::filesystem;

std::string granular_key(const scene::Scene& scene) {
    scene::Scene key;
    key.granular = scene.granular;
    key.granular->output.checkpoint = scene::GranularOutput{}.checkpoint;
    key.granular->runs = 1; // an unfinished ensemble may grow
    std::string text = scene::to_plain_toml(key);
    if (!scene.granular->start_file.empty()) // another file of the same name is another bed
        text += fmt::format("# start_file {:016x}\n",
                            store::content_hash(start_file_of(*scene.granular, scene.path), ""));
    return text;
}

fs::path run_folder(const fs::path& ensemble, std::int64_t run) {
    return ensemble / fmt::format("runs/{:04}", run + 1);
}

std::vector<GranularTask> granular_tasks(const Case& case_, const fs::path& directory) {
    const long runs = case_.scene.granular->runs;
    const fs::path folder = case_.folder.empty() ? directory : directory / case_.folder;
    std::vector<GranularTask> tasks;
    for (std::uint32_t run = 0; run < static_cast<std::uint32_t>(runs); ++run)
        tasks.push_back({run, runs == 1 ? folder : run_folder(folder, run)});
    return tasks;
}

std::optional<GranularSummary> finished_before(const GranularPlan& plan, const GranularTask& task) {
    const auto loaded = load_checkpoint(task.folder / "final.rwc");
    if (!loaded)
        return std::nullopt;
    // The files that cannot be made of the last state. An ensemble that grows may grow out of XYZ.
    const GranularCheckpoint& last = loaded->checkpoint;
    const GranularSchedule& s = plan.bed.schedule;
    const auto there = [&](bool made, const char* name) { return !made || fs::exists(task.folder / name); };
    if (!(there(true, "table.csv") && there(!plan.bed.problem.rods.empty(), "tracks.csv") &&
          there(s.h5md, "trajectory.h5md") &&
          there(s.xyz && plan.bed.of.scene.granular->runs == 1, "trajectory.xyz") &&
          there(s.archive_every > 0, "archive.rwc") &&
          there(last.logs.period_frames > 0, "last_period.h5md")))
        return std::nullopt;
    // The measures of the way are written once more from the last state.
    const fs::path records = task.folder / "measure.rwc";
    const auto& measured = plan.bed.measures;
    if (measured && last.measure_keys == measured->key_text && !fs::exists(records)) {
        measure::Measures measures = measured->sums;
        measures.load(last.measures, records.string());
        write_records(records, *measured, measures);
    }
    remove_progress(task.folder); // of a run whose end was cut short
    auto known = read_summary(task.folder / "summary.json", plan.bed.problem, task.run);
    return known || last.scene != plan.scene_key ? std::move(known)
                                                 : std::optional(restore_summary(plan, task));
}

void require_same_run(const GranularTask& task, const std::string& key) {
    for (const char* name : {"checkpoint.rwc", "final.rwc"}) {
        const fs::path& file = task.folder / name;
        const auto loaded = load_checkpoint(file);
        if (loaded && loaded->checkpoint.scene != key)
            throw InputError(fmt::format(
                "{}: belongs to another scene ({}); choose another folder with -o, or --force to start anew",
                file.string(), first_difference(loaded->checkpoint.scene, key)));
    }
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
