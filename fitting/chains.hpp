#pragma once
// The parts of `sample` (posterior.hpp): most probable places, chains, mixing, evidence.

#include "mixture.hpp"
#include "rodwake/fitting/posterior.hpp"

namespace rodwake::fitting {

// Substreams of the random numbers of a chain.
inline constexpr std::uint32_t of_start = 0, of_bridge = 1, of_search = 2, of_blocks = 3;
inline constexpr std::size_t most_peaks = 4;

/// The most probable places, each with the Gaussian that the curvature there makes; those that hold next to
/// nothing beside the others are left out. The search begins at z and at places drawn from the prior.
Mixture peaks(const Density& density, const Eigen::VectorXd& from, const PosteriorMethod& method);

struct Draws {
    std::vector<Eigen::VectorXd> z;
    std::vector<double> log_density;
    double accepted = 0.0;
};

struct SampledChains {
    std::vector<Draws> draws;
    Mixture proposal; ///< of the far steps
};

/// Nothing if stop_requested said so.
std::optional<SampledChains> run_chains(const Density& density, const Mixture& start,
                                        const PosteriorMethod& method);
std::optional<rodwake::Estimate> evidence(const Density& density, const SampledChains& chains,
                                          const PosteriorMethod& method);

/// Of draws by chain, of the values themselves.
double effective_samples(const std::vector<std::vector<double>>& chains);

} // namespace rodwake::fitting
