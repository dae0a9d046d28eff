#pragma once
// From the [granular] tables of a scene to a granular problem and to what follows from the two. Both are SI.

#include "rodwake/granular/problem.hpp"
#include "rodwake/scene/scene.hpp"

#include <cstdint>
#include <optional>

namespace rodwake::cli {

/// The bed of a scene that has one, validated. `seed_override` replaces granular.seed. Throws InputError,
/// with the scene's name, for what cannot be modelled. A restarted run has no start: with start = "restart"
/// the caller takes the state from granular.restart_from, and `start` of the problem means nothing.
granular::GranularProblem granular_problem(const scene::Scene& scene,
                                           std::optional<std::uint64_t> seed_override);

/// round(time / step), not below `least`.
std::int64_t whole_steps(double time, double step, std::int64_t least = 0);

/// granular.equilibrate, or its default, s. Random starts need time to order: at phi_b = 0.70 a fluid settles
/// in 2 s, from the transition on (0.72) crystals grow, 8 s, ever slower the denser the bed, 24 s at 0.80.
double equilibration_time(const scene::Granular& bed, double phi_b);

/// granular.order_cutoff, or 1.4 d with d = 2 a sqrt(0.9069/phi_b), the spacing of a perfect triangular
/// lattice, m. Nothing without beads.
std::optional<double> order_cutoff(const scene::Granular& bed, double phi_b);

/// Intervals of frames and of rows of the table, s.
double frame_interval(const scene::Granular& bed);
double table_interval(const scene::Granular& bed);

} // namespace rodwake::cli
