#pragma once
// Sums of strain and polar vectors at each of many rods over all the others.
//
// K0 and K1 depend on the distance alone, so both rods of a pair share them; rods are lanes of vectors (see
// wake_kernel.hpp, whose accuracy and range these sums have, source by source).
//
// Bits: the sums depend on the rods, their order and the options but for `threads`; not on the lanes of a
// vector, the instruction set or the threads. With far wakes they depend on the C library, too.
//
// Far wakes: with tolerances and 0 <= eta <= 20 far wakes are summed as drifting heat on meshes, in a time
// that grows hardly faster than N, if that is cheaper, up to four rods a xi^2; near pairs are exact.
// Tolerances below 1e-10 f/mu/xi (polar: /xi^2) go pair by pair. Errors keep to the tolerances by
// measurement, not by a bound (studies/reports/rods.md, "Many rods"), and are random from rod to rod.
//
// Degenerate input:
//   no rods; one rod                                     nothing is written; sums of 0 (both return 0)
//   two rods at one place                                InputError
//   a place or heading NaN or infinite                   InputError, which names the rod
//   no threads, a tolerance negative or not finite       InputError, by the constructor

#include "rodwake/core/parallel.hpp"
#include "rodwake/elastic/wake_kernel.hpp"

#include <cstddef>
#include <memory>

namespace rodwake::elastic {

/// Fewer are faster pair by pair, and sooner than that is found out.
inline constexpr std::size_t fewest_far_rods = 500;

struct MutualWakesOptions {
    Accuracy accuracy = Accuracy::full;
    std::size_t threads = 1;
    double strain_tolerance = 0.0; ///< error of a strain by far wakes, f/mu per length; 0: none
    double polar_tolerance = 0.0;  ///< of each polar vector, f/mu per length^2; where these are asked for far
                                   ///< wakes are taken only if both tolerances are > 0
};

class MutualWakes {
public:
    /// Throws InputError for an illegal medium (see validate), no threads or a tolerance that is negative or
    /// not finite.
    explicit MutualWakes(const Medium& medium, const MutualWakesOptions& options = {});

    /// Overwrites the sums, one number a rod, lab components. Returns how many fields of a source at a rod
    /// were worked out one by one: N (N - 1) without far wakes. Throws InputError if two rods are at one
    /// place, for places or headings that are not finite and for spans of unlike lengths.
    std::size_t strain(std::span<const Source> rods, const StrainSums& sums) const;
    std::size_t strain_and_polar(std::span<const Source> rods, const StrainSums& strain,
                                 const PolarSums& polar) const;

    const Medium& medium() const { return kernel_.medium(); }
    const MutualWakesOptions& options() const { return options_; }

    struct Far; ///< what far wakes need to know of the medium

private:
    WakeKernel kernel_;
    MutualWakesOptions options_;
    std::shared_ptr<ThreadPool> team_; ///< of all copies; calls at one time share it as Team::run says
    std::shared_ptr<Far> far_;
};

} // namespace rodwake::elastic
