#include "dem_cases.hpp"
#include "dem_run.hpp"
#include "dem_summary.hpp"
#include "granular_problem.hpp"
#include "progress.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/scene/write.hpp"
#include "signals.hpp"
#include "stages.hpp"

#include <fmt/format.h>

#include <atomic>
#include <mutex>
#include <sstream>

namespace rodwake::cli {

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

DemPlan plan_of(const Session& session, const scene::Scene& scene) {
    const scene::Granular& bed = *scene.granular;
    DemPlan plan;
    plan.problem = granular_problem(scene, session.options.seed);
    const double phi_b = granular::bead_area_fraction(plan.problem);
    plan.order_cutoff = order_cutoff(bed, phi_b).value_or(0.0);
    plan.scene_key = scene_key(scene);
    plan.measures = measure_plan(scene, plan.problem);
    plan.command = session.options.command;
    plan.row_every = whole_steps(table_interval(bed), bed.time_step, 1);
    plan.frame_every = whole_steps(frame_interval(bed), bed.time_step, 1);
    plan.checkpoint_every = bed.output.checkpoint;
    plan.stop_at_travel = bed.stop_at_travel.value_or(0.0);
    const auto wants = [&](const char* format) { return std::ranges::count(bed.output.formats, format) > 0; };
    plan.formats = {wants("h5md"), wants("xyz"), bed.output.last_period};
    if (bed.start == scene::GranularStart::restart)
        plan.restart = stored_state(bed.restart_from, session.log);
    plan.force = session.options.force;
    return plan;
}

/// The scene as written or a variant of it, and its runs.
struct PlannedCase {
    DemCase of;
    DemPlan plan;
    std::vector<DemTask> tasks;
    std::vector<DemResult> results;
};

std::vector<PlannedCase> planned_cases(const Session& session) {
    std::vector<PlannedCase> cases;
    for (DemCase& one : dem_cases(session.scene)) {
        DemPlan plan = plan_of(session, one.scene);
        std::vector<DemTask> tasks = dem_tasks(one, session.directory.path());
        std::vector<DemResult> results(tasks.size());
        cases.push_back({std::move(one), std::move(plan), std::move(tasks), std::move(results)});
    }
    return cases;
}

/// One run of one case.
struct Job {
    PlannedCase* of;
    std::size_t task;
};

std::vector<Job> jobs_of(std::vector<PlannedCase>& cases) {
    std::vector<Job> jobs;
    for (PlannedCase& one : cases)
        for (std::size_t i = 0; i < one.tasks.size(); ++i)
            jobs.push_back({&one, i});
    return jobs;
}

double simulated_seconds(const DemPlan& plan) {
    return static_cast<double>(plan.problem.steps + plan.problem.equilibration_steps) *
           plan.problem.time_step;
}

/// Progress of all runs together, in simulated seconds; called from many threads.
class SharedProgress {
public:
    SharedProgress(const Session& session, const std::vector<Job>& jobs)
        : log_(session.log), single_(jobs.size() == 1), of_one_(simulated_seconds(jobs.front().of->plan)),
          done_(jobs.size(), 0.0), progress_(session.log, session.options.quiet, "dem", total(jobs), "s") {}

    void update(std::size_t job, const granular::Simulation& s, const granular::TableRow* row) {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock)
            return;
        const double now = static_cast<double>(s.step()) * s.problem().time_step;
        sum_ += now - done_[job];
        done_[job] = now;
        progress_.update(sum_);
        if (row && single_ && now >= next_line_)
            print(*row);
    }

private:
    static double total(const std::vector<Job>& jobs) {
        double sum = 0.0;
        for (const Job& job : jobs)
            sum += simulated_seconds(job.of->plan);
        return sum;
    }

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
    double of_one_, sum_ = 0.0, next_line_ = 0.0;
    std::vector<double> done_;
    Progress progress_;
    std::mutex mutex_;
};

/// The summary of a run of an ensemble that an earlier command finished; require_dem saw that it is of this
/// scene.
std::optional<DemSummary> finished_before(const DemPlan& plan, const DemTask& task) {
    auto known = read_summary(task.folder / "summary.json", plan, task.run);
    return known && load_checkpoint(task.folder / "final.rwc") ? std::move(known) : std::nullopt;
}

/// The first line in which two scene texts differ, as "duration = 30.0 there, duration = 20.0 here".
std::string first_difference(const std::string& there, const std::string& here) {
    std::istringstream a(there), b(here);
    std::string line_a, line_b;
    while (std::getline(a, line_a) && std::getline(b, line_b))
        if (line_a != line_b)
            return fmt::format("{} there, {} here", line_a, line_b);
    return "one has more keys than the other";
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
DemResult execute(const Session& session, const Job& job, std::size_t number, std::size_t threads,
                  SharedProgress& progress) {
    const DemPlan& plan = job.of->plan;
    const DemTask& task = job.of->tasks[job.task];
    if (!plan.force)
        if (auto known = finished_before(plan, task))
            return {DemEnd::finished, {}, std::move(*known)};
    if (stop_signal())
        return {DemEnd::interrupted, {}, {}};
    return run_dem(plan, task, session.log, threads,
                   [&](const granular::Simulation& s, const granular::TableRow* row) {
                       progress.update(number, s, row);
                   });
}

void report_one(const Session& session, const DemSummary& s) {
    session.log->info(
        "dem: {:.4g} s simulated in {:.3g} s of CPU; T_xy {:.4g}, T_z {:.4g} m^2/s^2, psi6 {:.3f}, largest "
        "overlap {:.4f} a",
        s.simulated_time, s.cpu_seconds, s.T_xy, s.T_z, s.psi6, s.max_overlap);
    for (std::size_t i = 0; i < s.rods.size(); ++i)
        session.log->info("dem: rod {} ({}): {:.4g} mm/s thin end first, turned by {:.4g} rad", i,
                          s.rods[i].kind, 1e3 * s.rods[i].mean_speed, s.rods[i].net_turn);
}

StageEnd conclude(const Session& session, const PlannedCase& one) {
    std::vector<DemSummary> finished;
    StageEnd end = StageEnd::finished;
    const std::string name = one.of.label.empty() ? "" : " (" + one.of.label + ")";
    for (const DemResult& result : one.results) {
        if (result.end == DemEnd::finished)
            finished.push_back(result.summary);
        if (result.end == DemEnd::failed)
            session.log->error("dem{}: run {}: {}", name, result.summary.run + 1, result.message);
        if (result.end == DemEnd::interrupted && end == StageEnd::finished)
            end = StageEnd::interrupted;
        if (result.end == DemEnd::failed)
            end = StageEnd::failed;
    }
    if (one.results.size() == 1 && !finished.empty() && one.of.label.empty())
        report_one(session, finished[0]);
    if (one.results.size() > 1 && !finished.empty()) {
        session.directory.write(one.of.folder + "summary.json",
                                ensemble_json(one.plan, finished, one.results.size()));
        session.directory.write(one.of.folder + "runs.csv", ensemble_csv(one.plan, finished));
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

void announce(const Session& session, const std::vector<PlannedCase>& cases) {
    for (const PlannedCase& one : cases) {
        const granular::GranularProblem& p = one.plan.problem;
        session.log->info(
            "dem{}: beads {}, rods {}, phi_b = {:.4f}, runs {}, steps {} + {} of {:g} s; {} instructions",
            one.of.label.empty() ? "" : " (" + one.of.label + ")", p.beads, p.rods.size(),
            granular::bead_area_fraction(p), one.tasks.size(), p.equilibration_steps, p.steps, p.time_step,
            granular::vector_target());
    }
}

} // namespace

void require_same_beds(const scene::Scene& scene, const std::filesystem::path& folder) {
    for (const DemCase& one : dem_cases(scene))
        for (const DemTask& task : dem_tasks(one, folder))
            for (const char* name : {"checkpoint.rwc", "final.rwc"})
                require_same_scene(task.folder / name, scene_key(one.scene));
}

void require_dem(const scene::Scene& scene, const Options& options) {
    if (!options.force)
        require_same_beds(scene, output_folder(options));
    for (const DemCase& one : dem_cases(scene)) {
        measure_plan(one.scene, granular_problem(one.scene, options.seed));
        const scene::Granular& bed = *one.scene.granular;
        if (bed.start != scene::GranularStart::restart)
            continue;
        stored_checkpoint(bed.restart_from);
        if (const auto folder = output_folder(options); within(bed.restart_from, folder))
            throw InputError(bed.restart_from + ": granular.restart_from lies in " + folder.string() +
                             ", where this run would replace it; choose another folder with -o");
    }
}

StageEnd run_dem_stage(Session& session) {
    std::vector<PlannedCase> cases = planned_cases(session);
    const std::vector<Job> jobs = jobs_of(cases);
    announce(session, cases);
    SharedProgress progress(session, jobs);
    const bool single = jobs.size() == 1;
    parallel_for(jobs.size(), session.options.threads, [&](std::size_t i) {
        jobs[i].of->results[jobs[i].task] =
            execute(session, jobs[i], i, single ? session.options.threads : 1, progress);
    });
    StageEnd end = StageEnd::finished;
    for (const PlannedCase& one : cases)
        end = worse(end, conclude(session, one));
    return end;
}

} // namespace rodwake::cli
