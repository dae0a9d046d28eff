#pragma once
// The stages of a run. Each is described once, by a function that stands with what it does: who asks for it,
// what its results depend on and which files they are, what it costs, how it is run. Plans, folders,
// catalogue, manifest and costs go by the list.

#include "catalogue.hpp"
#include "rodwake/app/run_context.hpp"
#include "rodwake/scan/mpi.hpp"
#include "session.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rodwake::app {

/// What becomes of the other stages of a folder when a command has begun.
struct StageChanges {
    std::function<bool(Stage)> redone;  ///< with other results, perhaps
    std::function<bool(Stage)> dropped; ///< of another scene, and not asked for
};

/// Where inputs of a plan are looked for.
struct InputRequest {
    const std::filesystem::path& folder; ///< of the run, whose earlier stages may have made them
    const RunContext& context;
    bool made_later; ///< the same command makes beds or measures, so they may be missing now
    bool check;      ///< nothing is run: what is missing is described
};

struct StageKind {
    Stage stage; ///< one that is missing in the list of stages (app/plan.hpp) does not compile
    bool (*has_table)(const scene::Scene&) = nullptr;
    /// Whether `rodwake run` does it; null: only where a command asks for it.
    bool (*wanted)(const scene::Scene&) = nullptr;
    /// What its results depend on, as text.
    std::string (*key)(const scene::Scene&) = nullptr;
    std::vector<FileKind> (*files)() = nullptr;
    /// Adds to the inputs what the scene names in other files. Throws InputError; null: it names none.
    void (*read)(PlanInputs& inputs, const scene::Scene&, const InputRequest&) = nullptr;
    StageEnd (*run)(Session&) = nullptr;
    /// On a rank of an MPI job but the first: does work of the stage; null: ranks have none.
    void (*serve)(const Plan&, const std::filesystem::path& folder, const RunContext&,
                  scan::MpiJob&) = nullptr;
    /// Hands later stages what an earlier command made; null: they read it in the folder.
    void (*take_kept)(Session&) = nullptr;
    /// Throws InputError for what cannot be, before anything of the folder is touched; null: nothing.
    void (*require)(const Plan&, const std::filesystem::path& folder, const RunContext&) = nullptr;
    /// What `check` says of its cost; null: nothing to speak of.
    std::string (*cost)(const Plan&, const std::filesystem::path& folder, const RunContext&) = nullptr;
    /// Whether its results no longer follow from those of other stages; null: they follow from none.
    bool (*outdated)(const scene::Scene&, const StageChanges&) = nullptr;
    /// Whether one that is finished goes on for a scene of the same key; null: never.
    bool (*grows)(const scene::Scene& old, const scene::Scene&) = nullptr;
    /// Whether one that is finished would lose results to a scene of the same key, or would not be of it if
    /// the command does not ask for it; null: never.
    bool (*conflicts)(const scene::Scene& old, const scene::Scene&, bool asked) = nullptr;
    /// Whether one that is finished left something out that the scene wants by now; null: never.
    bool (*lacks)(const std::filesystem::path& folder, const scene::Scene&) = nullptr;
    /// An unfinished one has nothing to lose by another key: its own files know what they are of.
    bool light = false;
    /// It has a group of its name in result.h5.
    bool datasets = false;
};

const StageKind& kind_of(Stage stage);
/// In the order in which they are done.
const std::vector<Stage>& all_stages();

// One for each value of Stage.
#define RODWAKE_DECLARE(name) StageKind name##_stage();
RODWAKE_STAGES(RODWAKE_DECLARE)
#undef RODWAKE_DECLARE

// What several stages depend on. `add` takes along what is the stage's own.

/// Beds as they are, whatever they are called in legends and whatever else the variants change.
std::string key_of_beds(const scene::Scene& scene,
                        const std::function<void(scene::Scene& key, const scene::Scene& of)>& add = {});
/// The medium, and of rods all that moves them.
scene::Scene key_of_field(const scene::Scene& scene);
scene::Scene key_of_rods(const scene::Scene& scene);
/// Whether a bed, or a scan of beds, is asked for more runs than it was.
bool wants_more_runs(const scene::Scene& old, const scene::Scene& scene);

/// Whether a command adds to a run that is there: rodwake measure.
bool only_measures(const Plan& plan);
/// Throws InputError if the folder holds no run.
void require_run(const Plan& plan, const std::filesystem::path& folder);
/// Throws InputError if the folder holds granular runs of another scene.
void require_same_beds(const scene::Scene& scene, const std::filesystem::path& folder);

} // namespace rodwake::app
