#pragma once
// From the [measure] table of a scene to what is measured of each run, and when. SI.

#include "rodwake/granular/bead_kinds.hpp"
#include "rodwake/granular/problem.hpp"
#include "rodwake/measure/measures.hpp"
#include "rodwake/scene/scene.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::app {

struct MeasurePlan {
    measure::Measures sums; ///< of no frames yet: what each run starts with
    double interval = 0.0;  ///< between measured frames, s
    std::int64_t every = 1; ///< the same in steps
    /// Measures go by measure.interval, which is so many of them: more than 1 where currents need them
    /// closer.
    std::size_t stride = 1;
    std::string key_text; ///< of what the sums depend on; sums of another text are of no use
    /// Sizes of the beads that frames must have, and how many are nearest to each kind, where the scene alone
    /// tells; of tracks none.
    std::optional<granular::BeadMix> mix = {};
    std::vector<std::size_t> kind_counts = {};
};

/// What every frame of a bed has.
measure::Layout layout_of(const granular::GranularProblem& problem);

/// Nothing without [measure], or if no frame is needed for what it names. Throws InputError.
std::optional<MeasurePlan> measure_plan(const scene::Scene& scene, const granular::GranularProblem& problem);

/// The same for tracks, of this layout and with frames so far apart, s. Throws InputError.
MeasurePlan measure_plan(const scene::Scene& scene, const measure::Layout& layout, double interval);

/// Between the frames that are measured, s; of tracks with a column of times as far as the scene tells, 0 if
/// it does not.
double measured_interval(const scene::Scene& scene);

/// From measure.from to the end, s; of [tracks], whose length stands in their file, `film` or, unknown, no
/// end.
double measured_duration(const scene::Scene& scene, std::optional<double> film);

/// Steps of measure.interval.
std::int64_t steps_between_frames(const scene::Scene& scene);

} // namespace rodwake::app
