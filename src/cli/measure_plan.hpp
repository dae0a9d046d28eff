#pragma once
// From the [measure] table of a scene to what is measured of each run, and when. SI.

#include "rodwake/granular/problem.hpp"
#include "rodwake/measure/measures.hpp"
#include "rodwake/scene/scene.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace rodwake::cli {

struct MeasurePlan {
    measure::Layout layout;
    measure::MeasureKeys keys;
    double interval = 0.0;  ///< between measured frames, s
    std::int64_t every = 1; ///< the same in steps
    std::string key_text;   ///< of what the records depend on; records of another text are of no use
};

/// Nothing without [measure], or if no frame is needed for what it names. Throws InputError.
std::optional<MeasurePlan> measure_plan(const scene::Scene& scene, const granular::GranularProblem& problem);

/// U_y's profile along x, and the distance at which two rods touch, m.
double profile_offset(const scene::Scene& scene);
double contact_distance(const scene::Scene& scene);

} // namespace rodwake::cli
