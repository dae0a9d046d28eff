#include "chains.hpp"

#include "prior_map.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

namespace rodwake::fitting {

namespace {

constexpr std::size_t block_samples = 50, seen_of_sample = 2;

/// As many as are kept, within limits.
std::size_t warm_up_blocks(const PosteriorMethod& method) {
    return std::clamp<std::size_t>(method.samples / method.chains / block_samples, 6, 20);
}

/// Enough for four independent samples of ten where no far step is ever taken.
constexpr std::size_t steps_a_sample(std::size_t free) { return 2 * (free + 2); }

/// Where a chain begins: two standard deviations about one of the peaks, so that chains that do not mix are
/// seen.
ChainBlock first_block(const Density& density, const PosteriorMethod& method, std::size_t chain,
                       const Mixture& start) {
    RandomStream random(method.seed, static_cast<std::uint32_t>(chain), of_start);
    ChainBlock block;
    block.chain = chain;
    block.log_density = -HUGE_VAL; // at a peak, where this ends, the model exists
    Eigen::VectorXd z;
    for (double spread = 2.0; !std::isfinite(block.log_density);
         spread = spread > 1e-9 ? 0.5 * spread : 0.0) {
        z = start.about(chain % start.parts(), spread, random);
        block.log_density = density.at(z);
    }
    block.z.assign(z.begin(), z.end());
    block.log_scale = std::log(2.38 / std::sqrt(static_cast<double>(density.size())));
    return block;
}

/// The block `index` of a chain, which goes on from the block before. A chain that warms up keeps all its
/// points, half as far apart, for the proposal to learn from.
ChainBlock next_block(const Density& density, const PosteriorMethod& method, const ChainBlock& from,
                      std::size_t index, const Mixture& proposal) {
    const bool warm = index < warm_up_blocks(method);
    const std::size_t each = steps_a_sample(from.z.size()), all = method.samples / method.chains,
                      apart = warm ? each / seen_of_sample : each;
    const std::size_t count =
        warm ? block_samples
             : std::min(block_samples, all - (index - warm_up_blocks(method)) * block_samples);
    RandomStream random(method.seed, static_cast<std::uint32_t>(from.chain),
                        of_blocks + static_cast<std::uint32_t>(index));
    const Eigen::MatrixXd root = proposal.common_root(); // of the near steps
    Eigen::VectorXd z = Eigen::Map<const Eigen::VectorXd>(from.z.data(), density.size());
    std::size_t accepted = 0;
    ChainBlock block = from;
    block.index = index;
    block.kept.clear(), block.kept_density.clear();
    for (std::size_t i = 0; i < count * each; ++i) {
        // Half of the steps are far ones, drawn from the proposal. Of the near ones some are long and some
        // short, for tails and bends that the covariance does not show.
        const bool far = random.uniform() < 0.5;
        const double kind = far ? 1.0 : random.uniform(), factor = kind < 0.1 ? 0.1 : kind < 0.2 ? 3.0 : 1.0;
        const Eigen::VectorXd there = far ? proposal.draw(random)
                                          : Eigen::VectorXd(z + factor * std::exp(block.log_scale) *
                                                                    (root * normal_draws(random, z.size())));
        const double log_density = density.at(there);
        double log_odds = log_density - block.log_density;
        if (far)
            log_odds = log_odds + proposal.log_density(z) - proposal.log_density(there);
        const double odds = std::exp(std::min(0.0, log_odds));
        if (random.uniform() < odds) {
            z = there;
            block.log_density = log_density;
            ++accepted;
        }

        // The length of near steps is adapted while the chain warms up, until 30 % are accepted.
        if (warm && !far && factor == 1.0)
            block.log_scale += 1.0 / std::pow(static_cast<double>(i + 1), 0.6) * (odds - 0.3);
        if ((i + 1) % apart == 0) {
            block.kept.insert(block.kept.end(), z.begin(), z.end());
            if (!warm)
                block.kept_density.push_back(block.log_density);
        }
    }
    block.z.assign(z.begin(), z.end());
    block.accepted = static_cast<double>(accepted) / static_cast<double>(count * each);
    return block;
}

Eigen::VectorXd kept_at(const ChainBlock& block, std::size_t k) {
    return Eigen::Map<const Eigen::VectorXd>(&block.kept[k * block.z.size()],
                                             static_cast<Eigen::Index>(block.z.size()));
}

} // namespace

std::size_t block_count(const PosteriorMethod& method) {
    const std::size_t each = method.samples / method.chains;
    return method.chains * (warm_up_blocks(method) + (each + block_samples - 1) / block_samples);
}

double evaluations(const PosteriorMethod& method, std::size_t free) {
    const std::size_t kept = method.samples + method.chains * warm_up_blocks(method) * block_samples;
    return static_cast<double>(kept * steps_a_sample(free) + (method.evidence ? method.samples : 0));
}

std::size_t most_numbers_of_block(std::size_t free) {
    return free + block_samples * (seen_of_sample * free + 1);
}

std::optional<SampledChains> run_chains(const Density& density, const Mixture& start,
                                        const PosteriorMethod& method) {
    std::map<std::pair<std::size_t, std::size_t>, const ChainBlock*> earlier;
    for (const ChainBlock& block : method.done)
        earlier[{block.chain, block.index}] = &block;
    std::vector<ChainBlock> last; // of each chain
    for (std::size_t c = 0; c < method.chains; ++c)
        last.push_back(first_block(density, method, c, start));
    Mixture proposal = start;
    std::mutex mutex;
    bool stopped = false;
    const auto advance = [&](std::size_t c, std::size_t index) { // false if the run is stopped
        if (const auto at = earlier.find({c, index}); at != earlier.end()) {
            last[c] = *at->second;
            return true;
        }
        {
            const std::lock_guard lock(mutex);
            stopped = stopped || (method.stop_requested && method.stop_requested());
            if (stopped)
                return false;
        }
        last[c] = next_block(density, method, last[c], index, proposal);
        const std::lock_guard lock(mutex);
        if (method.on_block_done)
            method.on_block_done(last[c]);
        return true;
    };

    // While the chains warm up they learn the proposal from each other, block by block. It learns from the
    // later half of the blocks, because the points where the chains began say nothing about the density.
    const std::size_t warm_up = warm_up_blocks(method), blocks = block_count(method) / method.chains;
    std::vector<char> done(method.chains, 1);
    std::vector<std::vector<Eigen::VectorXd>> seen; // by block
    for (std::size_t i = 0; i < warm_up; ++i) {
        parallel_for(method.chains, method.threads, [&](std::size_t c) { done[c] = advance(c, i); });
        if (std::ranges::count(done, 0) > 0)
            return std::nullopt;
        auto& now = seen.emplace_back();
        for (const ChainBlock& block : last)
            for (std::size_t k = 0; (k + 1) * block.z.size() <= block.kept.size(); ++k)
                now.push_back(kept_at(block, k));
        std::vector<Eigen::VectorXd> late;
        for (std::size_t b = (i + 1) / 2; b <= i; ++b)
            late.insert(late.end(), seen[b].begin(), seen[b].end());
        proposal = proposal.learned(late, 2);
    }

    // Then each chain samples by itself.
    SampledChains out{std::vector<Draws>(method.chains), proposal};
    parallel_for(method.chains, method.threads, [&](std::size_t c) {
        Draws& draws = out.draws[c];
        for (std::size_t i = warm_up; i < blocks && done[c]; ++i)
            if ((done[c] = advance(c, i))) {
                for (std::size_t j = 0; j < last[c].kept_density.size(); ++j)
                    draws.z.push_back(kept_at(last[c], j));
                draws.log_density.insert(draws.log_density.end(), last[c].kept_density.begin(),
                                         last[c].kept_density.end());
                draws.accepted += last[c].accepted * static_cast<double>(last[c].kept_density.size());
            }
        draws.accepted /= static_cast<double>(draws.z.size());
    });
    return std::ranges::count(done, 0) > 0 ? std::nullopt : std::optional(std::move(out));
}

} // namespace rodwake::fitting
