#pragma once
// A run of a scene: planned, then executed stage by stage into a folder. What `rodwake run`, `dem`,
// `measure`, `fit`, `field` and `rods` do, without a command line:
//
//   const scene::Scene scene = scene::read_scene("pair.toml");
//   run(plan_run(scene, stages_of(scene), "results/pair", {}), "results/pair", {});

#include "rodwake/app/plan.hpp"
#include "rodwake/app/run_context.hpp"
#include "rodwake/scan/mpi.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace rodwake::app {

/// Files to fit that a run of the scene itself makes: they must be there, are left out since the run makes
/// them anew, or are read where they are there.
enum class OwnFiles { required, left_out, if_there };

/// The data that [fit] names, from files in the run directory, beside the scene or where the program runs;
/// the first that exists counts. Throws InputError naming file:line for what is missing or wrong.
FitInputs read_fit_inputs(const scene::Scene& scene, const std::filesystem::path& run_directory,
                          OwnFiles own);

/// The plan of these stages in that folder, with the context's seed. Throws InputError for what cannot be
/// modelled and for files that are missing or wrong; nothing is written. Whether the folder can be used,
/// run() says.
Plan plan_run(scene::Scene scene, std::span<const Stage> stages, const std::filesystem::path& folder,
              const RunContext& context);

/// The plan of all stages the scene names, to be described: of the data of a fit those count that are there.
/// Throws InputError as plan_run does.
Plan plan_check(scene::Scene scene, const std::filesystem::path& folder, const RunContext& context);

/// What the stages of a plan will cost: a line each, a table of what that consists of, and what leaving a
/// part out or loosening a setting would save; from about half a second of the work itself on this machine.
/// Tables of the field are read or made, and kept, as the run does it.
std::string expected_cost(const Plan& plan, const std::filesystem::path& folder, const RunContext& context);

/// Executes a plan. What was computed is kept however it ends; the same call goes on from there. Throws
/// InputError if the folder cannot be used (another scene's run, a finished one without `force`), RunError if
/// results cannot be written.
StageEnd run(const Plan& plan, const std::filesystem::path& folder, const RunContext& context);

/// On a rank of an MPI job but the first: evaluates points of the plan's scan, or runs its beds, for it. The
/// plan is of one stage, granular or scan.
void serve(const Plan& plan, const std::filesystem::path& folder, const RunContext& context,
           scan::MpiJob& job);

/// A file of a run folder, with its folder, and what it is.
struct FileEntry {
    std::string name, what;
    bool progress = false; ///< to go on from; gone when its stage has ended
};
/// The files in a run folder that rodwake made, in the order of their names.
std::vector<FileEntry> files_of_run(const std::filesystem::path& folder);

/// A column of a CSV file.
struct ColumnEntry {
    std::string name, unit, meaning;
    bool known = false; ///< a run makes it; else it has neither unit nor meaning
};
/// The columns of a CSV file, in their order; of one in a run folder in the units of that run.
std::vector<ColumnEntry> columns_of(const std::filesystem::path& file);
/// What a file of this name is, if runs make such.
std::string what_of(const std::filesystem::path& file);
/// What manifest.json of a run folder is to say now: {"files": {name: {what, stage, columns: [{name, unit,
/// meaning}]}}} of the files that are there, names with their folder.
std::string manifest_json(const std::filesystem::path& folder);

/// Brings manifest.json of a run folder up to date: every file in it, what it is, and its columns with units.
void write_manifest(const std::filesystem::path& folder);

/// What a checkpoint of a granular run (*.rwc) holds, in a few lines and the scene's text. Throws InputError
/// for a damaged one.
std::string describe_checkpoint(const std::filesystem::path& file);

/// A table of scenes ("scan", "[scan]"), a key ("coupling.kappa", "rods.0.position", "eta"), a file
/// ("scan.csv"), a column of a CSV file or a key of a JSON file ("mean_speed0", "drift"): all that is known
/// of it, in lines. Nothing for a name that is none of these.
std::optional<std::string> explain(const std::string& name);

/// docs/files.md: every file of a run, with its columns.
std::string file_reference();

/// Names near this one, the nearest first; then those whose meaning has the word. At most eight.
std::vector<std::string> similar_names(const std::string& name);

} // namespace rodwake::app
