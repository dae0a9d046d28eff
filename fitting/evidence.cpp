#include "chains.hpp"
#include "rodwake/core/parallel.hpp"

#include <atomic>
#include <cmath>

namespace rodwake::fitting {

namespace {

/// Ratios of the target to the proposal in logarithms: at draws of the proposal, and at samples by chain.
struct Ratios {
    std::vector<double> drawn;
    std::vector<std::vector<double>> sampled;
};

/// Relative variance of the mean of f if all were independent, times their number.
double relative_variance(const std::vector<double>& f, double mean) {
    double sum = 0.0;
    for (const double one : f)
        sum += (one - mean) * (one - mean) / (mean * mean);
    return sum / static_cast<double>(f.size());
}

/// The optimal bridge of Meng and Wong by their iteration; the error is that of Fruehwirth-Schnatter (2004).
class Bridge {
public:
    explicit Bridge(const Ratios& ratios)
        : ratios_(ratios), drawn_(ratios.drawn.size()), sampled_(ratios.sampled) {
        double count = 0.0;
        for (const auto& chain : ratios.sampled)
            for (const double one : chain)
                shift_ = std::max(shift_, one), count += 1.0;
        share_ = count / (count + static_cast<double>(drawn_.size()));
    }

    rodwake::Estimate solve() {
        double log_r = 0.0, top = 0.0, bottom = 0.0;
        for (int round = 0; round < 1000; ++round) {
            top = mean_drawn(log_r), bottom = mean_sampled(log_r);
            const double change = std::log(top) - std::log(bottom);
            log_r += change;
            if (!(std::abs(change) > 1e-10))
                break;
        }
        double variance = relative_variance(drawn_, top) / static_cast<double>(drawn_.size());
        std::vector<double> all;
        for (const auto& chain : sampled_)
            all.insert(all.end(), chain.begin(), chain.end());
        if (const double of_samples = relative_variance(all, bottom); of_samples > 0.0)
            variance += of_samples / effective_samples(sampled_);
        return {log_r + shift_, std::sqrt(variance), drawn_.size()};
    }

private:
    double mean_drawn(double log_r) {
        double sum = 0.0;
        for (std::size_t i = 0; i < drawn_.size(); ++i) {
            const double x = std::exp(ratios_.drawn[i] - shift_ - log_r);
            sum += drawn_[i] = std::isinf(x) ? 1.0 / share_ : x / (share_ * x + 1.0 - share_);
        }
        return sum / static_cast<double>(drawn_.size());
    }

    double mean_sampled(double log_r) {
        double sum = 0.0, count = 0.0;
        for (std::size_t c = 0; c < sampled_.size(); ++c)
            for (std::size_t i = 0; i < sampled_[c].size(); ++i, count += 1.0)
                sum += sampled_[c][i] =
                    1.0 / (share_ * std::exp(ratios_.sampled[c][i] - shift_ - log_r) + 1.0 - share_);
        return sum / count;
    }

    const Ratios& ratios_;
    std::vector<double> drawn_;
    std::vector<std::vector<double>> sampled_;
    double shift_ = -HUGE_VAL, share_ = 0.5; ///< share: of the samples among all
};

} // namespace

std::optional<rodwake::Estimate> evidence(const Density& density, const SampledChains& chains,
                                          const PosteriorMethod& method) {
    std::vector<Eigen::VectorXd> first;
    for (const Draws& chain : chains.draws)
        first.insert(first.end(), chain.z.begin(),
                     chain.z.begin() + static_cast<std::ptrdiff_t>(chain.z.size() / 2));
    const Mixture proposal = chains.proposal.learned(first, 4);
    Ratios ratios;
    for (const Draws& chain : chains.draws) {
        auto& list = ratios.sampled.emplace_back();
        for (std::size_t i = chain.z.size() / 2; i < chain.z.size(); ++i)
            list.push_back(chain.log_density[i] - proposal.log_density(chain.z[i]));
    }
    ratios.drawn.resize(method.samples);
    std::atomic<bool> stopped = false;
    parallel_for(method.samples, method.threads, [&](std::size_t i) {
        if (i % 64 == 0 && method.stop_requested && method.stop_requested())
            stopped = true;
        if (stopped)
            return;
        RandomStream random(method.seed, static_cast<std::uint32_t>(i), of_bridge);
        const Eigen::VectorXd z = proposal.draw(random);
        ratios.drawn[i] = density.at(z) - proposal.log_density(z);
    });
    return stopped ? std::nullopt : std::optional(Bridge(ratios).solve());
}

} // namespace rodwake::fitting
