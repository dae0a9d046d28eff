#pragma once
// From [[rods]], [medium], [coupling] and [rods_run] to a problem of the rods part. No physics: names and
// units only.

#include "rodwake/rods/noise.hpp"
#include "rodwake/scene/scene.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace rodwake::assembly {

rods::Couplings couplings_of(const scene::Scene& scene);
rods::RodProblem rod_problem(const scene::Scene& scene);
/// Method "auto" is settled here, by rods::suitable_method.
rods::RodOptions rod_options(const scene::RodsRun& run, const rods::RodProblem& problem);

/// An ensemble of noisy runs.
struct NoisePlan {
    rods::Noise noise;
    std::uint32_t runs = 1;
};
/// None for rods that do not diffuse. A time step that the scene leaves open is settled here.
std::optional<NoisePlan> noise_plan(const scene::Scene& scene, const rods::RodProblem& problem);

/// What one reduced unit is worth in the results, and its name: reduced scenes report reduced numbers, SI
/// scenes SI.
struct OutputUnits {
    double length = 1.0, time = 1.0;
    std::string system = "reduced", length_name = "f/mu", time_name = "f/(mu v0)";
};
OutputUnits output_units(const scene::Scene& scene);
/// Of the files of [rods_order]: the same, or SI for rods of a bed.
OutputUnits order_units(const scene::Scene& scene);

} // namespace rodwake::assembly
