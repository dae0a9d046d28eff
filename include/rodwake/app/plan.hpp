#pragma once
// Everything that a run of a scene will do, made once: what `rodwake check` describes is what the stages
// execute.

#include "rodwake/app/fit.hpp"
#include "rodwake/app/granular.hpp"
#include "rodwake/app/measure.hpp"
#include "rodwake/app/rods.hpp"
#include "rodwake/app/scan.hpp"
#include "rodwake/scene/scene.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rodwake::app {

// A scene stands for several cases: itself as written and one for each of its [[variants]].

struct Case {
    std::string name;   ///< of the variant; "scene" for the scene as written
    std::string label;  ///< for legends, where it may hold TeX; empty for the scene as written
    std::string folder; ///< where its files go, "" or "variants/<name>/"
    scene::Scene scene;

    /// " (name)" for messages; empty for the scene as written.
    std::string suffix() const { return label.empty() ? "" : " (" + name + ")"; }
};

/// The scene as written, then each variant.
std::vector<Case> cases_of(const scene::Scene& scene);

/// The scene as written, and its variants whose [granular] differs from it (others change the rods only).
std::vector<Case> bed_cases(const scene::Scene& scene);

const char* to_string(scene::FieldBackend backend);

/// The stages that a run can consist of, in the order in which they are done. A stage is added here and in a
/// file of its own, which defines the function <name>_stage() that describes it (app/run/stage_kind.hpp).
#define RODWAKE_STAGES(stage)                                                                                \
    stage(granular) stage(measure) stage(fit) stage(field) stage(rods) stage(order) stage(scan)
#define RODWAKE_NAME(name) name,
enum class Stage { RODWAKE_STAGES(RODWAKE_NAME) end }; ///< `end` is none
#undef RODWAKE_NAME
const char* to_string(Stage stage);

/// Whether the scene has the table that the stage works on: [granular], [measure], ...
bool has_table(const scene::Scene& scene, Stage stage);

/// The stages a scene names: measures of a stored trajectory need no granular run, and a scan of beds takes
/// the place of the bed as written and its measures.
std::vector<Stage> stages_of(const scene::Scene& scene);

/// One bed: the scene as written, or a variant of it.
struct BedPlan {
    Case of;
    granular::GranularProblem problem;
    GranularSchedule schedule;
    std::optional<MeasurePlan> measures; ///< what needs frames of the bed; absent: nothing does
};

/// One set of rods in the elastic medium: the scene as written, or a variant of it.
struct RodsPlan {
    Case of;
    rods::RodProblem problem;
    rods::RodOptions options;
    std::optional<NoisePlan> noise; ///< absent: none
};

struct Plan {
    scene::Scene scene;
    std::vector<Stage> stages;
    std::vector<BedPlan> beds;  ///< of a scan of beds the scene as written, which its points vary
    std::vector<RodsPlan> rods; ///< with medium.fitted, those of the medium the scene starts with
    std::optional<FitInputs> fit;
    std::optional<FitPlan> fit_plan; ///< absent until all data are there
    std::optional<ScanPlan> scan;
    std::vector<std::string> tracks; ///< as in PlanInputs

    bool has(Stage stage) const;
};

/// What a scene names and stands in other files.
struct PlanInputs {
    std::optional<FitInputs> fit;         ///< what could be read of the data that [fit] names
    std::optional<ScanList> list;         ///< scan.file
    std::vector<std::string> tracks = {}; ///< what the files of [tracks] begin with, for people
};

/// The problems of these stages. Throws InputError for what cannot be modelled.
Plan make_plan(const scene::Scene& scene, std::span<const Stage> stages, PlanInputs inputs = {});

/// The cases of the theory stage, for a scene with [[rods]] and [rods_run].
std::vector<RodsPlan> plan_rods(const scene::Scene& scene);

/// A seed from outside becomes part of the scene, so that the scene of the run makes the same run again.
/// Throws InputError for one that a scene cannot hold.
void apply_seed(scene::Scene& scene, std::uint64_t seed);

} // namespace rodwake::app
