#pragma once
// Samples of the parameters given data and priors, and the evidence of the model.
//
//   log p(values) = -chi2/2 - sum log(sigma sqrt(2 pi)) + log prior
//
// Each parameter is mapped by its prior's distribution function to the line, z = Phi^-1(F(value)), so that
// there all priors are standard normal and no bound is left. The sampler is a random walk (Metropolis) whose
// steps follow the curvature at the most probable place and adapt in the first blocks, then stay: it needs
// one evaluation and no derivative a step, and takes places where the model does not exist as refused. The
// evidence is bridge sampling (Meng and Wong 1996) between samples and a Gaussian fitted to half of them.

#include "rodwake/core/estimate.hpp"
#include "rodwake/fitting/prior.hpp"
#include "rodwake/fitting/problem.hpp"

#include <cstdint>
#include <optional>

namespace rodwake::fitting {

/// A stretch of a chain: its end, from which the next begins, and the samples kept meanwhile.
struct ChainBlock {
    std::size_t chain = 0, index = 0;
    std::vector<double> z;
    double log_density = 0.0, log_scale = 0.0;
    std::vector<double> covariance;         ///< of the steps, row by row
    std::vector<double> kept, kept_density; ///< z of all samples one after the other; log density in z
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

/// Blocks that all chains have together, and the most samples that one holds.
std::size_t block_count(const PosteriorMethod& method);
inline constexpr std::size_t block_samples = 50;

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
    std::optional<rodwake::Estimate> log_evidence;
    std::vector<std::string> remarks; ///< chains that do not mix, in sentences
};

/// Throws InputError for priors that are improper. `priors`: of the free parameters; `from`: values of all,
/// where the most probable place is searched. Nothing if stop_requested said so. Depends on the seed, not on
/// threads or on what was done before.
std::optional<Posterior> sample(const Problem& problem, const std::vector<Prior>& priors,
                                std::span<const double> from, const PosteriorMethod& method);

/// Of draws by chain.
Marginal marginal(const std::vector<std::vector<double>>& chains);

} // namespace rodwake::fitting
