#pragma once
// The problems of a scan's points, one after the other. Where all keys that vary are couplings or places of
// rods, their values go straight into the problem, and no scene is set.

#include "rodwake/app/plan.hpp"
#include "rodwake/app/rods.hpp"
#include "rodwake/app/run_context.hpp"
#include "rodwake/app/scan.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace rodwake::app {

struct RunTables; // app/bed/measure_kind.hpp

/// A thread has its own. The plan must outlive it.
class PointProblem {
public:
    explicit PointProblem(const ScanPlan& plan);

    /// Until the next call. Throws InputError for values that the scene refuses.
    const rods::RodProblem& at(const scan::Point& point);
    /// The settings of the run at the point of the last call.
    const scene::RodsRun& run() const { return *scene_->rods_run; }
    /// Its noise; none if its rods do not diffuse.
    std::optional<NoisePlan> noise() const { return noise_plan(*scene_, problem_); }

private:
    /// Where the value of a key goes, if it needs nothing else of the scene; null: it does.
    static double* place_of(const ScanPlan::VariedKey& key, const scene::Scene& scene,
                            rods::RodProblem& problem);

    const ScanPlan& plan_;
    std::unique_ptr<scene::Scene> scene_;
    rods::RodProblem problem_;
    std::vector<double*> direct_; ///< as the plan's keys; empty: through the scene
};

// Points of a scan of beds: the bed of each, and what a finished run of it yields.

/// The bed of a point. Throws InputError for one that cannot be modelled.
BedPlan scanned_bed(const ScanPlan& plan, const scan::Point& point);

struct BedObservables {
    std::int32_t outcome = 0;   ///< index into Columns::outcomes
    std::vector<double> values; ///< as Columns::observables
};

/// From what the run wrote: lengths in a, the rest SI. Throws InputError for files that are not of such a
/// run.
BedObservables observables_of(const scene::Scene& scene, const RunTables& run);

// Points of a scan evaluated by whoever a program hands them to: processes of a pool, nodes of a cluster.
// There each makes the plan anew from the scene and evaluates the points that it is sent; in the process that
// runs the scan RunContext::executor sends them and takes the results. Points and results are plain data
// (scan/point.hpp), and a result depends on scene and point alone.

/// Evaluates points of this plan, which must outlive it; `context.stop` ends it early. Beds run in folders
/// below that of the scan, those of rods leave no files. Says nothing.
scan::Evaluate point_evaluator(const ScanPlan& plan, const std::filesystem::path& folder,
                               const RunContext& context);

} // namespace rodwake::app
