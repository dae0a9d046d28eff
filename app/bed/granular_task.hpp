#pragma once
// The runs of a bed as tasks: which folder each has, and what an earlier command left of it.

#include "granular_run.hpp"

namespace rodwake::app {

/// The scene without what changes pictures and bookkeeping only: a checkpoint belongs to this text.
std::string granular_key(const scene::Scene& scene);

/// The runs of a case, one folder each; who executes them is another matter.
std::vector<GranularTask> granular_tasks(const Case& one, const std::filesystem::path& directory);

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
