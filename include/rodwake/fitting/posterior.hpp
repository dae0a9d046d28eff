#pragma once
// Samples of the parameters given data and priors (density.hpp), and the evidence of the model.
//
// Chains of Metropolis and Hastings in z, where all priors are standard normal. Half of the steps propose a
// place anywhere, from t distributions about the most probable places, half of them a place near the last
// one; both learn in the first blocks and stay as they are after that. A step takes one evaluation and no
// derivatives; places where the model does not exist are refused. The evidence is bridge sampling (Meng and
// Wong 1996) between samples and t distributions that half of them are fitted to.

#include "rodwake/core/estimate.hpp"
#include "rodwake/fitting/density.hpp"

#include <cstdint>
#include <optional>

namespace rodwake::fitting {

/// A stretch of a chain: its end, from which the next begins, and the samples kept meanwhile.
struct ChainBlock {
    std::size_t chain = 0, index = 0;
    double log_density = 0.0, log_scale = 0.0, accepted = 0.0; ///< accepted: share of the steps
    std::vector<double> z;
    /// z of all samples one after the other, and their log density in z; while the chain warms up the places
    /// seen, without it.
    std::vector<double> kept, kept_density;
};

struct PosteriorMethod {
    std::size_t chains = 4, samples = 4000; ///< kept, of all chains together; a multiple of chains
    bool evidence = true;
    std::uint64_t seed = 1;
    std::size_t threads = 1;
    std::vector<ChainBlock> done = {};                         ///< of an earlier run, any order
    std::function<void(const ChainBlock&)> on_block_done = {}; ///< one at a time
    std::function<bool()> stop_requested = {};
};

/// Blocks that all chains have together.
std::size_t block_count(const PosteriorMethod& method);
/// Evaluations of the residuals that samples and evidence take; the search for places takes a few hundred
/// more.
double evaluations(const PosteriorMethod& method, std::size_t free);
/// No block holds more numbers in its lists.
std::size_t most_numbers_of_block(std::size_t free);

struct Marginal {
    double mean = 0.0, sd = 0.0, median = 0.0, q025 = 0.0, q975 = 0.0;
    double rhat = 0.0; ///< split, of ranks (Vehtari et al. 2021)
    double ess = 0.0;  ///< effective samples of the ranks, all chains together
};

struct Posterior {
    std::vector<std::size_t> free;                        ///< parameters, as indices of the problem's
    std::vector<std::vector<std::vector<double>>> values; ///< [free parameter][chain][draw]
    std::vector<std::vector<double>> log_likelihood;      ///< [chain][draw]
    std::vector<Marginal> marginals;                      ///< of the free parameters
    std::vector<double> accepted;                         ///< share of the steps, by chain
    std::optional<rodwake::Estimate> log_evidence;
    std::vector<std::string> remarks; ///< what is not to be trusted, in sentences
};

/// Throws InputError for priors that are improper, RunError where the model does not exist at `from`: values
/// of all parameters, where the search for the most probable places begins. `priors`: of the free parameters.
/// Nothing if stop_requested said so. Depends on the seed, not on threads or on what was done before.
std::optional<Posterior> sample(const Problem& problem, const std::vector<Prior>& priors,
                                std::span<const double> from, const PosteriorMethod& method);

/// Of draws by chain.
Marginal marginal(const std::vector<std::vector<double>>& chains);

} // namespace rodwake::fitting
