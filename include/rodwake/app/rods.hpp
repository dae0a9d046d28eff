#pragma once
// From [[rods]], [medium], [coupling] and [rods_run] to a problem of the rods part. No physics: names and
// units only.

#include "rodwake/rods/noise_ensemble.hpp"
#include "rodwake/scene/scene.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace rodwake::app {

/// As the scene has them, in the basis of the rods part.
rods::Couplings own_couplings(const scene::Coupling& coupling);
/// With what coupling.gamma_flow adds to them.
rods::Couplings couplings_of(const scene::Scene& scene);
rods::RodProblem rod_problem(const scene::Scene& scene);
/// Method "auto" is settled here, by rods::suitable_method.
rods::RodOptions rod_options(const scene::RodsRun& run, const rods::RodProblem& problem);

/// An ensemble of noisy runs.
struct NoisePlan {
    rods::Noise noise;
    std::uint32_t runs = 1;
    std::optional<double> capture_error; ///< half the interval that is wanted; absent: `runs` will do
    std::uint32_t most_runs = 0;         ///< with capture_error
};
/// None for rods that do not diffuse. A time step that the scene leaves open is settled here.
std::optional<NoisePlan> noise_plan(const scene::Scene& scene, const rods::RodProblem& problem);

/// How many runs are wanted after those there are: `runs`, then half as many again while half the 95 %
/// interval (Wilson) of the capture probability of the first so many is wider than capture_error, up to
/// most_runs. A run that failed among them ends it. Depends on the runs' numbers and ends alone: the same
/// however they were done. What stopping by the interval does to it: docs/noise.md.
std::uint32_t wanted_runs(const rods::NoiseSums& sums, std::size_t rods, const NoisePlan& plan);

/// Adds runs until there are as many as are wanted. False if options.ode.stop_requested stopped it: the
/// same call goes on, to the same runs.
bool run_wanted(const rods::RodProblem& problem, const rods::RodOptions& options, const NoisePlan& plan,
                std::size_t threads, rods::NoiseSums& sums,
                const std::function<void(const rods::NoiseSums&)>& added = nullptr);

/// What one reduced unit is worth in the results, and its name: reduced scenes report reduced numbers, SI
/// scenes SI.
struct OutputUnits {
    double length = 1.0, time = 1.0;
    std::string system = "reduced", length_name = "f/mu", time_name = "f/(mu v0)";
};
OutputUnits output_units(const scene::Scene& scene);
/// Of the files of [rods_order]: the same, or SI for rods of a bed.
OutputUnits order_units(const scene::Scene& scene);

} // namespace rodwake::app
