#pragma once
// The problems of a scan's points, one after the other. Where all keys that vary are couplings or places of
// rods, their values go straight into the problem, and no scene is set.

#include "rodwake/app/rods.hpp"
#include "rodwake/app/scan.hpp"

#include <memory>

namespace rodwake::app {

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

} // namespace rodwake::app
