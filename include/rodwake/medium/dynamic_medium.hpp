#pragma once
// The medium with its memory: no wake is assumed steady (paper Eq. (13), docs/memory.md).
//
//   beta d_tt u + alpha d_t u = lap u + eta grad div u + sum_b n_b g_w(r - R_b),
//   g_w = exp(-r^2/(2 w^2))/(2 pi w^2)
//
// Reduced units: lengths f/mu, times f/(mu v0), u in f/mu, alpha = (f/mu)/xi. The inertia beta = rho v0^2/mu,
// rho the mass per area, is the square of the rod's speed over that of transverse sound, sqrt(mu/rho); the
// paper has none. On a periodic square of side
// `box`, with the wave vectors q = (2 pi/box) (m, n), |m|, |n| < modes/2; the zero mode, which only drifts,
// is left out. A rod pushes the medium along its heading, as in elastic/field.hpp, where the same rod walking
// straight for ever has the field U of alpha = 1/xi: its wake there is this medium's for w -> 0, modes ->
// inf.
//
// Against that point force the error of a field is w^2 lap U/2 + O(w^4) away from the rod, as smoothing goes,
// and exp(-(pi modes w/box)^2/2) from the modes left out (studies/reports/medium.md).

#include "rodwake/elastic/medium.hpp"

#include <cstddef>
#include <optional>

namespace rodwake::medium {

/// What the medium holds at t = 0.
enum class Start {
    steady, ///< the fields of rods that have always walked straight along their first headings
    rest    ///< nothing: undeformed and at rest
};

/// How forces become modes, and modes strain at the rods.
enum class Evaluation {
    automatic, ///< sums up to most_fields rods, or most_summed in one field for all; beyond them the mesh
    sums,      ///< over all modes for each rod, exact but for rounding
    mesh       ///< fast Fourier transforms, one field for all rods, to mesh_error
};

/// What the field of a rod knows of the rod's past.
enum class Closure {
    none,       ///< all of it: the medium is integrated with the rods
    steady,     ///< nothing: it is that of a rod that has always walked straight along its present heading
    first_order ///< its turning rate: it is, to first order in theta', that of a rod that turns
                ///< (turning_wake.hpp). Better in slow turns only (studies/reports/medium.md), so not a
                ///< choice of scenes
};

struct DynamicMedium {
    double box = 40.0;        ///< side, f/mu
    double force_width = 0.5; ///< w, f/mu: at least a grid spacing, box/modes, at most box/4
    std::size_t modes = 96;   ///< 4 to 2048
    bool self_field = false;  ///< each rod in its own field too; false: in those of the others alone
    Start start = Start::steady;
    Closure closure = Closure::none; ///< others than none: with Start::steady, sums and inertia = 0 only
    Evaluation evaluation = Evaluation::automatic;
    double inertia = 0.0;                     ///< rho v0^2/mu, 0 to 1e6
    std::optional<double> film_interval = {}; ///< f/(mu v0), of the frames of film.hpp; absent: none
    std::size_t film_grid = 128;              ///< their points a side

    bool operator==(const DynamicMedium&) const = default;
};

/// With sums and without self_field each rod needs a field of its own: at most so many.
inline constexpr std::size_t most_fields = 64;
/// Rods from which on the mesh is the faster in one field for all (studies/reports/medium.md).
inline constexpr std::size_t most_summed = 16;
/// Of turning rates that the mesh gives, over the largest of them (studies/reports/medium.md).
inline constexpr double mesh_error = 1e-11;
/// What amplitudes and weights of all rods may take; beyond, fewer modes or rods.
inline constexpr double most_bytes = 2e9;

/// Which of the two `rods` rods get.
Evaluation evaluation_of(const DynamicMedium& medium, std::size_t rods);

/// Bytes that `rods` rods take in this medium while they are integrated.
double bytes_needed(const DynamicMedium& medium, std::size_t rods);

/// Throws InputError for what is outside the domain above, for an illegal elastic medium, and for more rods
/// than can be held.
void validate(const elastic::Medium& elastic, const DynamicMedium& medium, std::size_t rods);

} // namespace rodwake::medium
