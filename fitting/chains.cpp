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

/// Steps of one chain, block by block.
class Chain {
public:
    Chain(const Density& density, const PosteriorMethod& method, std::size_t chain)
        : density_(density), method_(method), chain_(chain) {}

    /// Two standard deviations about one of the peaks, so that chains that do not mix are seen.
    ChainBlock begin(const Mixture& start) const {
        RandomStream random(method_.seed, number(), of_start);
        ChainBlock block;
        block.chain = chain_;
        block.log_density = -HUGE_VAL; // at a peak, where this ends, the model exists
        Eigen::VectorXd z;
        for (double spread = 2.0; !std::isfinite(block.log_density);
             spread = spread > 1e-9 ? 0.5 * spread : 0.0) {
            z = start.about(chain_ % start.parts(), spread, random);
            block.log_density = density_.at(z);
        }
        block.z.assign(z.begin(), z.end());
        block.log_scale = std::log(2.38 / std::sqrt(static_cast<double>(density_.size())));
        return block;
    }

    /// While it warms up all that it sees is kept, half as far apart, for the proposal to learn from.
    ChainBlock next(const ChainBlock& from, std::size_t index, const Mixture& proposal) const {
        const bool warm = index < warm_up_blocks(method_);
        const std::size_t each = steps_a_sample(from.z.size()), all = method_.samples / method_.chains,
                          apart = warm ? each / seen_of_sample : each;
        const std::size_t count =
            warm ? block_samples
                 : std::min(block_samples, all - (index - warm_up_blocks(method_)) * block_samples);
        RandomStream random(method_.seed, number(), of_blocks + static_cast<std::uint32_t>(index));
        ChainState state{Eigen::Map<const Eigen::VectorXd>(from.z.data(), density_.size()), from.log_density,
                         from.log_scale, proposal.common_root()};
        ChainBlock block = from;
        block.index = index;
        block.kept.clear(), block.kept_density.clear();
        for (std::size_t i = 0; i < count * each; ++i) {
            step(state, proposal, random, warm ? 1.0 / std::pow(static_cast<double>(i + 1), 0.6) : 0.0);
            if ((i + 1) % apart == 0) {
                block.kept.insert(block.kept.end(), state.z.begin(), state.z.end());
                if (!warm)
                    block.kept_density.push_back(state.log_density);
            }
        }
        block.z.assign(state.z.begin(), state.z.end());
        block.log_density = state.log_density, block.log_scale = state.log_scale;
        block.accepted = static_cast<double>(state.accepted) / static_cast<double>(count * each);
        return block;
    }

private:
    struct ChainState {
        Eigen::VectorXd z;
        double log_density, log_scale;
        Eigen::MatrixXd root; ///< of the near steps
        std::size_t accepted = 0;
    };

    std::uint32_t number() const { return static_cast<std::uint32_t>(chain_); }

    void step(ChainState& state, const Mixture& proposal, RandomStream& random, double gain) const {
        if (random.uniform() < 0.5)
            far(state, proposal, random);
        else
            near(state, random, gain);
    }

    void far(ChainState& state, const Mixture& proposal, RandomStream& random) const {
        const Eigen::VectorXd there = proposal.draw(random);
        const double density = density_.at(there), odds = density - state.log_density +
                                                          proposal.log_density(state.z) -
                                                          proposal.log_density(there);
        take(state, there, density, std::exp(std::min(0.0, odds)), random);
    }

    /// Now and then a long or a short one: for tails and bends that the covariance does not show.
    void near(ChainState& state, RandomStream& random, double gain) const {
        const double kind = random.uniform(), factor = kind < 0.1 ? 0.1 : kind < 0.2 ? 3.0 : 1.0;
        const Eigen::VectorXd there = state.z + factor * std::exp(state.log_scale) *
                                                    (state.root * normal_draws(random, state.z.size()));
        const double density = density_.at(there),
                     odds = std::exp(std::min(0.0, density - state.log_density));
        take(state, there, density, odds, random);
        if (factor == 1.0)
            state.log_scale += gain * (odds - 0.3);
    }

    static void take(ChainState& state, const Eigen::VectorXd& there, double density, double odds,
                     RandomStream& random) {
        if (!(random.uniform() < odds))
            return;
        state.z = there;
        state.log_density = density;
        ++state.accepted;
    }

    const Density& density_;
    const PosteriorMethod& method_;
    std::size_t chain_;
};

Eigen::VectorXd kept_at(const ChainBlock& block, std::size_t k) {
    return Eigen::Map<const Eigen::VectorXd>(&block.kept[k * block.z.size()],
                                             static_cast<Eigen::Index>(block.z.size()));
}

/// What the chains share: earlier blocks, and one at a time to the caller.
class Progressing {
public:
    explicit Progressing(const PosteriorMethod& method) : method_(method) {
        for (const ChainBlock& block : method.done)
            done_[{block.chain, block.index}] = &block;
    }

    const ChainBlock* done(std::size_t chain, std::size_t index) const {
        const auto at = done_.find({chain, index});
        return at == done_.end() ? nullptr : at->second;
    }
    bool stopped() {
        const std::lock_guard lock(mutex_);
        return stopped_ = stopped_ || (method_.stop_requested && method_.stop_requested());
    }
    void report(const ChainBlock& block) {
        const std::lock_guard lock(mutex_);
        if (method_.on_block_done)
            method_.on_block_done(block);
    }

private:
    const PosteriorMethod& method_;
    std::map<std::pair<std::size_t, std::size_t>, const ChainBlock*> done_;
    std::mutex mutex_;
    bool stopped_ = false;
};

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

namespace {

/// All chains, block by block: together while they warm up, for they learn from each other, then each by
/// itself.
class ChainRun {
public:
    ChainRun(const Density& density, const Mixture& start, const PosteriorMethod& method)
        : density_(density), method_(method), progress_(method), proposal_(start) {
        for (std::size_t c = 0; c < method.chains; ++c)
            at_.push_back(Chain(density, method, c).begin(start));
    }

    /// False if it was stopped.
    bool warm_up() {
        std::vector<std::vector<Eigen::VectorXd>> seen; // by block
        for (std::size_t i = 0; i < warm_up_blocks(method_); ++i) {
            std::vector<char> done(method_.chains);
            parallel_for(method_.chains, method_.threads, [&](std::size_t c) { done[c] = advance(c, i); });
            if (std::ranges::count(done, 0) > 0)
                return false;
            auto& now = seen.emplace_back();
            for (const ChainBlock& block : at_)
                for (std::size_t k = 0; (k + 1) * block.z.size() <= block.kept.size(); ++k)
                    now.push_back(kept_at(block, k));
            std::vector<Eigen::VectorXd> late; // where the chains began tells nothing
            for (std::size_t b = (i + 1) / 2; b <= i; ++b)
                late.insert(late.end(), seen[b].begin(), seen[b].end());
            proposal_ = proposal_.learned(late, 2);
        }
        return true;
    }

    std::optional<SampledChains> sample() {
        SampledChains out{std::vector<Draws>(method_.chains), proposal_};
        const std::size_t blocks = block_count(method_) / method_.chains;
        std::vector<char> done(method_.chains, 1);
        parallel_for(method_.chains, method_.threads, [&](std::size_t c) {
            for (std::size_t i = warm_up_blocks(method_); i < blocks && done[c]; ++i)
                if ((done[c] = advance(c, i))) {
                    for (std::size_t j = 0; j < at_[c].kept_density.size(); ++j) {
                        out.draws[c].z.push_back(kept_at(at_[c], j));
                        out.draws[c].log_density.push_back(at_[c].kept_density[j]);
                    }
                    out.draws[c].accepted +=
                        at_[c].accepted * static_cast<double>(at_[c].kept_density.size());
                }
            out.draws[c].accepted /= static_cast<double>(out.draws[c].z.size());
        });
        return std::ranges::count(done, 0) > 0 ? std::nullopt : std::optional(std::move(out));
    }

private:
    bool advance(std::size_t c, std::size_t i) {
        if (const ChainBlock* before = progress_.done(c, i)) {
            at_[c] = *before;
            return true;
        }
        if (progress_.stopped())
            return false;
        at_[c] = Chain(density_, method_, c).next(at_[c], i, proposal_);
        progress_.report(at_[c]);
        return true;
    }

    const Density& density_;
    const PosteriorMethod& method_;
    Progressing progress_;
    Mixture proposal_;
    std::vector<ChainBlock> at_; ///< the last block of each
};

} // namespace

std::optional<SampledChains> run_chains(const Density& density, const Mixture& start,
                                        const PosteriorMethod& method) {
    ChainRun run(density, start, method);
    return run.warm_up() ? run.sample() : std::nullopt;
}

} // namespace rodwake::fitting
