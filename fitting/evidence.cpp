#include "chains.hpp"
#include "rodwake/core/parallel.hpp"

#include <atomic>
#include <cmath>

namespace rodwake::fitting {

namespace {

/// Relative variance of the mean of f if all were independent, times their number.
double relative_variance(const std::vector<double>& f, double mean) {
    double sum = 0.0;
    for (const double value : f)
        sum += (value - mean) * (value - mean) / (mean * mean);
    return sum / static_cast<double>(f.size());
}

} // namespace

// The optimal bridge of Meng and Wong by their iteration; the error is that of Fruehwirth-Schnatter (2004).
std::optional<rodwake::Estimate> evidence(const Density& density, const SampledChains& chains,
                                          const PosteriorMethod& method) {
    std::vector<Eigen::VectorXd> first;
    for (const Draws& chain : chains.draws)
        first.insert(first.end(), chain.z.begin(),
                     chain.z.begin() + static_cast<std::ptrdiff_t>(chain.z.size() / 2));
    const Mixture proposal = chains.proposal.learned(first, 4);

    // Ratios of the target to the proposal in logarithms: at samples by chain, and at draws of the proposal.
    std::vector<std::vector<double>> ratio_of_samples;
    for (const Draws& chain : chains.draws) {
        auto& list = ratio_of_samples.emplace_back();
        for (std::size_t i = chain.z.size() / 2; i < chain.z.size(); ++i)
            list.push_back(chain.log_density[i] - proposal.log_density(chain.z[i]));
    }
    std::vector<double> ratio_of_draws(method.samples);
    std::atomic<bool> stopped = false;
    parallel_for(method.samples, method.threads, [&](std::size_t i) {
        if (i % 64 == 0 && method.stop_requested && method.stop_requested())
            stopped = true;
        if (stopped)
            return;
        RandomStream random(method.seed, static_cast<std::uint32_t>(i), of_bridge);
        const Eigen::VectorXd z = proposal.draw(random);
        ratio_of_draws[i] = density.at(z) - proposal.log_density(z);
    });
    if (stopped)
        return std::nullopt;

    // Ratios are taken relative to the largest of the samples, whose share among all points is `share`.
    double count = 0.0, shift = -HUGE_VAL;
    for (const auto& list : ratio_of_samples)
        for (const double ratio : list)
            shift = std::max(shift, ratio), count += 1.0;
    const double share = count / (count + static_cast<double>(method.samples));
    std::vector<double> drawn(method.samples);
    std::vector<std::vector<double>> sampled = ratio_of_samples;
    double log_r = 0.0, mean_drawn = 0.0, mean_sampled = 0.0;
    for (int round = 0; round < 1000; ++round) {
        double sum = 0.0;
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            const double x = std::exp(ratio_of_draws[i] - shift - log_r);
            sum += drawn[i] = std::isinf(x) ? 1.0 / share : x / (share * x + 1.0 - share);
        }
        mean_drawn = sum / static_cast<double>(drawn.size());
        sum = 0.0;
        for (std::size_t c = 0; c < sampled.size(); ++c)
            for (std::size_t i = 0; i < sampled[c].size(); ++i)
                sum += sampled[c][i] =
                    1.0 / (share * std::exp(ratio_of_samples[c][i] - shift - log_r) + 1.0 - share);
        mean_sampled = sum / count;
        const double change = std::log(mean_drawn) - std::log(mean_sampled);
        log_r += change;
        if (!(std::abs(change) > 1e-10))
            break;
    }
    double variance = relative_variance(drawn, mean_drawn) / static_cast<double>(drawn.size());
    std::vector<double> all;
    for (const auto& list : sampled)
        all.insert(all.end(), list.begin(), list.end());
    if (const double of_samples = relative_variance(all, mean_sampled); of_samples > 0.0)
        variance += of_samples / effective_samples(sampled);
    return rodwake::Estimate{log_r + shift, std::sqrt(variance), drawn.size()};
}

} // namespace rodwake::fitting
