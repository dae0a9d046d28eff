#pragma once
// From the [granular] tables of a scene to a granular problem and to what follows from the two. Both are SI.

#include "rodwake/granular/problem.hpp"
#include "rodwake/granular/start.hpp"
#include "rodwake/scene/scene.hpp"

#include <optional>

namespace rodwake::app {

/// The bed of a scene that has one, validated. Throws InputError, with the scene's name, for what cannot be
/// modelled. A restarted run has no start: with start = "restart" the caller takes the state from
/// granular.restart_from, and `start` of the problem means nothing.
granular::GranularProblem granular_problem(const scene::Scene& scene);

/// granular.box as it is. With "fit": unstrained for the lattice that the start will take, phi_b kept as
/// given (to less than a bead), or with beads the area; the wanted size to half a lattice spacing a side,
/// about. Throws InputError if rows do not lie along a side (orientation no multiple of 30 degrees).
struct BedSize {
    PeriodicBox box;
    std::size_t beads = 0;
    std::optional<granular::LatticeBox> lattice; ///< with "fit"
};
BedSize bed_size(const scene::Granular& bed);

/// Of last_period.h5md; 38 to 75 where a whole number of steps lies between two.
inline constexpr std::int64_t period_frames = 50;

/// When what is stored of a run, and when it ends: what follows from [granular] beside the problem. SI.
struct GranularSchedule {
    double order_cutoff = 0.0;                   ///< of psi6, m; 0 without beads
    std::int64_t row_every = 1, frame_every = 1; ///< steps between rows of the table, and between frames
    double stop_at_travel = 0.0;                 ///< mean advance of the rods, m; 0: to the end
    bool h5md = true, xyz = false, last_period = true;
    std::size_t every_bead = 1;     ///< beads 0, every_bead, 2 every_bead, ... are in the frames
    std::int64_t archive_every = 0; ///< steps between kept states; 0: none are kept
};
GranularSchedule granular_schedule(const scene::Granular& bed, const granular::GranularProblem& problem);

/// granular.equilibrate, or what the start needs to settle (granular/start.hpp; a restart nothing), s.
double equilibration_time(const scene::Granular& bed, double phi_b);

/// granular.order_cutoff, or granular::neighbour_cutoff, m. Nothing without beads.
std::optional<double> order_cutoff(const scene::Granular& bed, double phi_b);

/// Beads and spheres of rods.
double spheres(const granular::GranularProblem& problem);

/// What a run costs, in any unit: spheres times steps, equilibration included.
double sphere_steps(const granular::GranularProblem& problem);

/// Intervals of frames and of rows of the table, s.
double frame_interval(const scene::Granular& bed);
double table_interval(const scene::Granular& bed);

/// Frames of a run that goes to its end, and their size as extended XYZ, about.
double frame_count(const scene::Granular& bed);
double xyz_bytes(const scene::Granular& bed, const granular::GranularProblem& problem);

/// Beads and spheres of rods that a frame holds.
double stored_spheres(const scene::Granular& bed, const granular::GranularProblem& problem);

} // namespace rodwake::app
