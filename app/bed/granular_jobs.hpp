#pragma once
// All runs of all beds of a plan as one list of work, for threads or for the ranks of an MPI job: ranks write
// into the folder, and who asked for the runs reads their summaries there.

#include "granular_run.hpp"
#include "rodwake/scan/mpi.hpp"

namespace rodwake::app {

/// A bed, its runs and how they ended.
struct BedWork {
    GranularPlan plan;
    std::vector<GranularTask> tasks;
    std::vector<GranularResult> results; ///< interrupted, as long as nothing else is known

    const Case& of() const { return plan.bed.of; }
};

/// One run of one bed.
struct GranularJob {
    BedWork* of;
    std::size_t task;

    const GranularTask& its() const { return of->tasks[task]; }
    GranularResult& result() const { return of->results[task]; }
};

std::vector<BedWork> beds_of(const Plan& plan, const std::filesystem::path& folder, const Logger& log);
/// In the order in which they are to start: the dearest first.
std::vector<GranularJob> jobs_of(std::vector<BedWork>& beds);

/// Seconds that are simulated in a run, equilibration included.
double simulated_seconds(const GranularPlan& plan);

/// Hears how far a job is; of one that somebody else executed only its end, without a simulation.
using OnJob = std::function<void(std::size_t job, const granular::Simulation*, const granular::TableRow*)>;

/// Executes the jobs that no earlier command finished and fills in their results. Throws what a job threw
/// that is no failure of its bed (a folder of another scene, a full disk), the first of them, after all
/// ended.
void execute_jobs(const std::vector<GranularJob>& jobs, const RunContext& context, const Logger& log,
                  const OnJob& on_job);

/// On a rank of an MPI job but the first: executes jobs of the plan for it.
void serve_beds(const Plan& plan, const std::filesystem::path& folder, const RunContext& context,
                scan::MpiJob& job);

/// The checkpoint of granular.restart_from. Throws InputError if there is none.
LoadedCheckpoint stored_checkpoint(const std::string& file);

/// The scene without what changes pictures and bookkeeping only: a checkpoint belongs to this text.
std::string granular_key(const scene::Scene& scene);

/// The runs of a case, one folder each; who executes them is another matter.
std::vector<GranularTask> granular_tasks(const Case& case_, const std::filesystem::path& directory);

/// The folder of run `run`, from 0, in that of an ensemble.
std::filesystem::path run_folder(const std::filesystem::path& ensemble, std::int64_t run);

/// The summary of a run that an earlier command finished and whose files are there; of those what the last
/// state tells is made again. That it is of this scene was seen before.
std::optional<GranularSummary> finished_before(const GranularPlan& plan, const GranularTask& task);

/// Throws InputError if the folder of a task holds a run of another scene, before anything of it is touched.
void require_same_run(const GranularTask& task, const std::string& key);

/// As run_granular tells it.
using OnProgress = std::function<void(const granular::Simulation&, const granular::TableRow*)>;

/// Executes a task unless an earlier command finished it; `context.force` does it anew.
GranularResult execute_task(const GranularPlan& plan, const GranularTask& task, const RunContext& context,
                            const Logger& log, std::size_t threads, const OnProgress& on_progress);

} // namespace rodwake::app
