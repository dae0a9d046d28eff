#pragma once
// Many noisy runs of one problem: how they end, and how rods turn and spread in them.
//
// Degenerate input: no runs give no ends and means that are NaN; one run gives means with errors that are
// NaN; of a single rod no captures are counted.

#include "rodwake/rods/noise.hpp"

#include <cstdint>
#include <functional>
#include <span>

namespace rodwake::rods {

/// One run of the ensemble.
struct NoisyEnd {
    bool failed = false; ///< the rest is that of the time it reached
    Ending ending = Ending::undecided;
    double time = 0.0; ///< of contact, else the time reached
    double min_separation = 0.0;
    std::size_t first = 0, second = 0; ///< the pair it is about
};

/// Sums over the runs so far, in the order of their numbers; a plain value that can be saved and taken up
/// again. Sums at a time are those of the runs that got there: of runs that stop at a contact fewer and
/// fewer.
struct NoiseSums {
    std::vector<NoisyEnd> ends;  ///< of each run
    std::string failure;         ///< why the first that failed did
    std::vector<double> reached; ///< by time: runs that did
    /// By time T and rod N at T * rods + N, of |r(t) - r(0)|^2 and of cos(theta(t) - theta(0)): sums and sums
    /// of squares.
    std::vector<double> square, square_squares, cosine, cosine_squares;
};

NoiseSums no_runs(const RodProblem& problem);
void add(NoiseSums& sums, const RodProblem& problem, const RodResult& run);

/// Means over the runs that got to a time, and their standard errors, as the sums [time][rod]; NaN where no
/// run did, errors also where one did.
struct NoiseMeans {
    std::vector<double> values, errors;
};
NoiseMeans mean_square_displacement(const NoiseSums& sums); ///< <|r(t) - r(0)|^2>
NoiseMeans heading_correlation(const NoiseSums& sums);      ///< <cos(theta(t) - theta(0))>

/// Runs that end in contact or pursuit, of those that did not fail; of a single rod none are tried.
struct CaptureCount {
    std::int64_t count = 0, of = 0;
};
CaptureCount count_captures(std::span<const NoisyEnd> ends, std::size_t rods);

/// Adds runs until there are `runs`, on `threads` threads; the bits do not depend on their number. `added` is
/// called after every few runs. False if options.ode.stop_requested stopped it: the sums are then those
/// of the runs done so far, and the same call goes on with them.
bool run_ensemble(const RodProblem& problem, const RodOptions& options, const Noise& noise,
                  std::uint32_t runs, std::size_t threads, NoiseSums& sums,
                  const std::function<void(const NoiseSums&)>& added = nullptr);

} // namespace rodwake::rods
