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

// medium.field = "auto": exact field or table, whichever makes the run of the rods cheaper. The choice
// follows from the scene alone: costs are constants measured once (docs/validation_elastic.md, "Tables of the
// field"), never times of this machine or what its cache holds, so that the same scene gives the same bits
// everywhere.
//
//   cost = make + n_rhs (N heading + N^2 wake),   n_rhs = 130 t_end sqrt(N)/D max(1, (1e-6/rtol)^(1/6))
//
// N rods in a box of side D (on the plane: as far apart as they start); make: seconds to make a table, 0 for
// the exact field; heading: a rod's field for a new heading (boxes); wake: one rod's wake at another's place.
// n_rhs was counted in boxes of 2 to 50 xi with 2 and 8 rods, which it meets within a factor of 2.

/// The field in which the rods of a scene are integrated.
struct FieldChoice {
    scene::FieldBackend backend = scene::FieldBackend::exact; ///< never automatic
    double tolerance = 0.0;                                   ///< of the table; 0: there is none
    std::string why;                                          ///< with "auto"; else empty
};

const char* to_string(scene::FieldBackend backend);

/// The table's tolerance under "auto" is medium.table.tolerance, else rtol: rods in a table of tolerance T
/// are within 100 T of the exact ones, which is what rtol = T makes of the solver's error.
FieldChoice field_choice(const scene::Scene& scene);

/// The scene with "auto" replaced by what was chosen.
scene::Scene with_field(scene::Scene scene, const FieldChoice& choice);

/// What a run can consist of, in the order in which it is done.
/// `end` is none.
enum class Stage { granular, measure, fit, field, rods, order, scan, end };
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
    Case of; ///< with medium.field as chosen
    rods::RodProblem problem;
    rods::RodOptions options;
    FieldChoice field;
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
