#include "granular_run.hpp"
#include "granular_summary.hpp"
#include "progress.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/first_difference.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/scene/write.hpp"
#include "stage_list.hpp"

#include <fmt/format.h>

#include <atomic>
#include <mutex>
#include <sstream>

namespace rodwake::stages {

namespace {

/// The scene without what changes pictures and bookkeeping only: a checkpoint belongs to this text.
std::string scene_key(const scene::Scene& scene) {
    scene::Scene key;
    key.granular = scene.granular;
    key.granular->output.checkpoint = scene::GranularOutput{}.checkpoint;
    key.granular->runs = 1; // an unfinished ensemble may grow
    return scene::to_plain_toml(key);
}

LoadedCheckpoint stored_checkpoint(const std::string& file) {
    auto loaded = load_checkpoint(file);
    if (!loaded)
        throw InputError(
            file + ": no such checkpoint (granular.restart_from); a finished run keeps its last state in "
                   "final.rwc, one that goes on in checkpoint.rwc");
    return std::move(*loaded);
}

granular::State stored_state(const std::string& file, const Logger& log) {
    LoadedCheckpoint loaded = stored_checkpoint(file);
    if (!loaded.notice.empty())
        log->warn("{}", loaded.notice);
    return std::move(loaded.checkpoint.state);
}

bool within(const std::filesystem::path& file, const std::filesystem::path& folder) {
    const auto below =
        std::filesystem::weakly_canonical(file).lexically_relative(std::filesystem::weakly_canonical(folder));
    return !below.empty() && *below.begin() != "..";
}

/// A bed, its runs and how they ended.
struct Work {
    GranularPlan plan;
    std::vector<GranularTask> tasks;
    std::vector<GranularResult> results;

    const assembly::Case& of() const { return plan.bed.of; }
};

std::vector<Work> work_of(const Session& session) {
    std::vector<Work> all;
    for (const assembly::BedPlan& bed : session.plan.beds) {
        Work work{{bed, scene_key(bed.of.scene), {}}, granular_tasks(bed.of, session.directory.path()), {}};
        const scene::Granular& keys = *bed.of.scene.granular;
        if (keys.start == scene::GranularStart::restart)
            work.plan.restart = stored_state(keys.restart_from, session.log);
        work.results.resize(work.tasks.size());
        all.push_back(std::move(work));
    }
    return all;
}

/// One run of one case.
struct Job {
    Work* of;
    std::size_t task;
};

std::vector<Job> jobs_of(std::vector<Work>& all) {
    std::vector<Job> jobs;
    for (Work& one : all)
        for (std::size_t i = 0; i < one.tasks.size(); ++i)
            jobs.push_back({&one, i});
    return jobs;
}

double simulated_seconds(const GranularPlan& plan) {
    const granular::GranularProblem& p = plan.bed.problem;
    return static_cast<double>(p.steps + p.equilibration_steps) * p.time_step;
}

double simulated_seconds(const std::vector<Job>& jobs) {
    double sum = 0.0;
    for (const Job& job : jobs)
        sum += simulated_seconds(job.of->plan);
    return sum;
}

/// Progress of all runs together, in simulated seconds, and of a single one a table of twenty rows.
class Telling {
public:
    Telling(const Session& session, const std::vector<Job>& jobs)
        : log_(session.log), single_(jobs.size() == 1), of_one_(simulated_seconds(jobs.front().of->plan)),
          progress_(session.context, "dem", jobs.size(), simulated_seconds(jobs), "s") {}

    void update(std::size_t job, const granular::Simulation& s, const granular::TableRow* row) {
        const bool told = progress_.update(job, static_cast<double>(s.step()) * s.problem().time_step);
        if (told && row && single_ && static_cast<double>(s.step()) * s.problem().time_step >= next_line_)
            print(*row);
    }

private:
    void print(const granular::TableRow& r) {
        if (next_line_ == 0.0)
            log_->info("{:>9} {:>11} {:>10} {:>10} {:>6} {:>8} {:>10} {:>8}", "t/s", "energy/J", "T_xy",
                       "T_z", "psi6", "contacts", "floor/N s", "overlap");
        log_->info("{:9.3f} {:11.4e} {:10.3e} {:10.3e} {:6.3f} {:8.1f} {:10.3e} {:8.4f}", r.t, r.energy,
                   r.T_xy, r.T_z, r.psi6, r.contacts, r.floor_impulse, r.max_overlap);
        next_line_ += of_one_ / 20.0;
    }

    Logger log_;
    bool single_;
    double of_one_, next_line_ = 0.0;
    SharedProgress progress_;
};

/// The summary of a run of an ensemble that an earlier command finished; require_dem saw that it is of this
/// scene.
std::optional<GranularSummary> finished_before(const GranularPlan& plan, const GranularTask& task) {
    auto known = read_summary(task.folder / "summary.json", plan.bed.problem, task.run);
    return known && load_checkpoint(task.folder / "final.rwc") ? std::move(known) : std::nullopt;
}

/// Refuses to take up what an earlier command left of another scene, before anything of it is touched.
void require_same_scene(const std::filesystem::path& file, const std::string& key) {
    const auto loaded = load_checkpoint(file);
    if (loaded && loaded->checkpoint.scene != key)
        throw InputError(fmt::format(
            "{}: belongs to another scene ({}); choose another folder with -o, or --force to start anew",
            file.string(), first_difference(loaded->checkpoint.scene, key)));
}

/// Executes one job unless an earlier command finished it.
GranularResult execute(const Session& session, const Job& job, std::size_t number, std::size_t threads,
                       Telling& progress) {
    const GranularPlan& plan = job.of->plan;
    const GranularTask& task = job.of->tasks[job.task];
    if (!session.context.force)
        if (auto known = finished_before(plan, task))
            return {StageEnd::finished, {}, std::move(*known)};
    if (session.context.stopped())
        return {StageEnd::interrupted, {}, {}};
    return run_granular(plan, task, session.context, session.log, threads,
                        [&](const granular::Simulation& s, const granular::TableRow* row) {
                            progress.update(number, s, row);
                        });
}

void report_one(const Session& session, const GranularSummary& s) {
    session.log->info(
        "dem: {:.4g} s simulated in {:.3g} s of CPU; T_xy {:.4g}, T_z {:.4g} m^2/s^2, psi6 {:.3f}, largest "
        "overlap {:.4f} a",
        s.simulated_time, s.cpu_seconds, s.T_xy, s.T_z, s.psi6, s.max_overlap);
    for (std::size_t i = 0; i < s.rods.size(); ++i)
        session.log->info("dem: rod {} ({}): {:.4g} mm/s thin end first, turned by {:.4g} rad", i,
                          s.rods[i].kind, 1e3 * s.rods[i].mean_speed, s.rods[i].net_turn);
}

StageEnd conclude(const Session& session, const Work& one) {
    std::vector<GranularSummary> finished;
    StageEnd end = StageEnd::finished;
    const std::string name = one.of().suffix();
    for (const GranularResult& result : one.results) {
        if (result.end == StageEnd::finished)
            finished.push_back(result.summary);
        if (result.end == StageEnd::failed)
            session.log->error("dem{}: run {}: {}", name, result.summary.run + 1, result.message);
        if (result.end == StageEnd::interrupted && end == StageEnd::finished)
            end = StageEnd::interrupted;
        if (result.end == StageEnd::failed)
            end = StageEnd::failed;
    }
    if (one.results.size() == 1 && !finished.empty() && one.of().label.empty())
        report_one(session, finished[0]);
    if (one.results.size() > 1 && !finished.empty()) {
        session.directory.write(one.of().folder + "summary.json",
                                ensemble_json(one.plan.bed.problem, finished, one.results.size()));
        session.directory.write(one.of().folder + "runs.csv", ensemble_csv(one.plan.bed.problem, finished));
        session.log->info("dem{}: {} of {} runs finished; runs.csv and summary.json have the means", name,
                          finished.size(), one.results.size());
    }
    return end;
}

/// The worst: a failure weighs more than an interruption.
StageEnd worse(StageEnd a, StageEnd b) {
    if (a == StageEnd::failed || b == StageEnd::failed)
        return StageEnd::failed;
    return a == StageEnd::finished ? b : a;
}

void announce(const Session& session, const std::vector<Work>& all) {
    for (const Work& one : all) {
        const granular::GranularProblem& p = one.plan.bed.problem;
        session.log->info(
            "dem{}: beads {}, rods {}, phi_b = {:.4f}, runs {}, steps {} + {} of {:g} s; {} instructions",
            one.of().suffix(), p.beads, p.rods.size(), granular::bead_area_fraction(p), one.tasks.size(),
            p.equilibration_steps, p.steps, p.time_step, granular::vector_target());
    }
}

} // namespace

void require_same_beds(const scene::Scene& scene, const std::filesystem::path& folder) {
    for (const assembly::Case& one : assembly::bed_cases(scene))
        for (const GranularTask& task : granular_tasks(one, folder))
            for (const char* name : {"checkpoint.rwc", "final.rwc"})
                require_same_scene(task.folder / name, scene_key(one.scene));
}

void require_granular(const assembly::Plan& plan, const std::filesystem::path& folder,
                      const RunContext& context) {
    if (!context.force)
        require_same_beds(plan.scene, folder);
    for (const assembly::BedPlan& one : plan.beds) {
        const scene::Granular& bed = *one.of.scene.granular;
        if (bed.start != scene::GranularStart::restart)
            continue;
        stored_checkpoint(bed.restart_from);
        if (within(bed.restart_from, folder))
            throw InputError(bed.restart_from + ": granular.restart_from lies in " + folder.string() +
                             ", where this run would replace it; choose another folder with -o");
    }
}

StageEnd run_granular_stage(Session& session) {
    std::vector<Work> all = work_of(session);
    const std::vector<Job> jobs = jobs_of(all);
    announce(session, all);
    Telling progress(session, jobs);
    const std::size_t threads = session.context.thread_count();
    const bool single = jobs.size() == 1;
    parallel_for(jobs.size(), threads, [&](std::size_t i) {
        jobs[i].of->results[jobs[i].task] = execute(session, jobs[i], i, single ? threads : 1, progress);
    });
    StageEnd end = StageEnd::finished;
    for (const Work& one : all)
        end = worse(end, conclude(session, one));
    return end;
}

} // namespace rodwake::stages
