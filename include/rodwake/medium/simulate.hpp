#pragma once
// Rods in a medium that remembers (dynamic_medium.hpp): rods and modes integrated together.
//
//   R_a' = n_a,   theta_a' = z.[n_a x (kappa eps.n_a + gamma1 lap u + gamma2 grad div u)]  at R_a,
//
// u the field of the other rods, with self_field that of all; many rods: less what own_response.hpp knows of
// a rod's own. Contacts of bodies add to these rates as in rods/body.hpp, and a rod that is pushed acts on
// the medium where it is. Reduced units, signs and couplings as in rods/model.hpp; places are unwrapped, u is
// periodic. Where rods/model.hpp turns each wake to its rod's heading at once, here it follows as the medium
// relaxes: that is the closure this part tests.
//
// Error: each step's errors are held to rtol and atol (studies/reports/medium.md has what comes of it at the
// end). A Gaussian force leaves no singularity where rods meet, so that without a contact distance they pass
// through each other.
//
// Cost: a step takes 12 evaluations, with sums of modes^2/2 modes for each rod, with the mesh of two Fourier
// transforms (bench/medium_bench.cpp).

#include "rodwake/medium/dynamic_medium.hpp"
#include "rodwake/medium/film.hpp"
#include "rodwake/rods/simulate.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace rodwake::medium {

/// `rods.medium` gives eta and xi; `rods.box`, if given, is medium.box; no field and no options of sums.
struct MediumProblem {
    rods::RodProblem rods;
    DynamicMedium medium;
};

struct MediumResult : rods::RodResult {
    /// With self_field, sums and up to most_fields rods: what each rod's own field turned it by, rad; its
    /// share of outcome.turn. Else empty.
    std::vector<double> own_turn;
};

/// Runs to t_end or to contact, as rods::simulate, whose options, checkpoints and results these are. The
/// method is that of this part (ode.method does not count), with a closure erk, the form angle. A checkpoint
/// comes every few seconds and when a run is interrupted; its state: poses, the next step, the amplitudes of
/// the fields. Deterministic, with the same bits for any rods.sums.threads. Throws InputError for what
/// validate or rods::simulate would not take, and for rods closer than force_width.
/// With a film_interval `film` gets the frames of film.hpp; those up to a checkpoint's time come before it,
/// and a run that is resumed goes on with the next. They change no other result.
MediumResult simulate(const MediumProblem& problem, const rods::RodOptions& options,
                      const FilmSink& film = nullptr);

/// As many of `threads` as repay what they cost the loops of a step.
std::size_t worthwhile_threads(const DynamicMedium& medium, std::size_t rods, std::size_t threads);

/// Throws InputError if two rods are closer than force_width, through the box's sides too: there the field is
/// that of the Gaussian, not of a rod.
void validate_start(const DynamicMedium& medium, std::span<const rods::Pose> rods,
                    std::optional<double> contact_distance = {});

/// Throws InputError for rods with bodies whose own fields the mesh does not know (own_response.hpp).
void validate_bodies(const DynamicMedium& medium, const rods::RodProblem& rods);

/// Numbers in a checkpoint's state: poses, the next step, own turns if they are kept apart, fields; with a
/// closure poses.
std::size_t state_size(const DynamicMedium& medium, std::size_t rods);

} // namespace rodwake::medium
