// How well chains tell of one distribution: Vehtari, Gelman, Simpson, Carpenter, Buerkner, Bayesian Analysis
// 16, 667 (2021).

#include "chains.hpp"
#include "prior_map.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::fitting {

namespace {

using Chains = std::vector<std::vector<double>>;

Chains halves(const Chains& chains) {
    Chains out;
    for (const auto& chain : chains) {
        const auto half = static_cast<std::ptrdiff_t>(chain.size() / 2);
        out.emplace_back(chain.begin(), chain.begin() + half);
        out.emplace_back(chain.end() - half, chain.end());
    }
    return out;
}

/// Normal scores of the ranks among all; equal values share their mean rank.
Chains scores(const Chains& chains) {
    std::vector<std::pair<double, double*>> all;
    Chains out = chains;
    for (auto& chain : out)
        for (double& value : chain)
            all.emplace_back(value, &value);
    std::ranges::sort(all, {}, &std::pair<double, double*>::first);
    const auto n = static_cast<double>(all.size());
    for (std::size_t i = 0, j = 0; i < all.size(); i = j) {
        while (j < all.size() && all[j].first == all[i].first)
            ++j;
        const double rank = 0.5 * static_cast<double>(i + j + 1);
        for (std::size_t k = i; k < j; ++k)
            *all[k].second = normal_quantile((rank - 0.375) / (n + 0.25));
    }
    return out;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double covariance_at(const std::vector<double>& values, double middle, std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < values.size(); ++i)
        sum += (values[i] - middle) * (values[i - lag] - middle);
    return sum / static_cast<double>(values.size());
}

struct Variances {
    double within = 0.0, all = 0.0;
};

Variances variances(const Chains& chains) {
    const auto m = static_cast<double>(chains.size()), n = static_cast<double>(chains.front().size());
    std::vector<double> means;
    Variances v;
    for (const auto& chain : chains) {
        means.push_back(mean(chain));
        v.within += covariance_at(chain, means.back(), 0) * n / (n - 1.0) / m;
    }
    const double between = covariance_at(means, mean(means), 0) * m / (m - 1.0);
    v.all = (n - 1.0) / n * v.within + between;
    return v;
}

double rhat(const Chains& chains) {
    const Variances v = variances(chains);
    return v.within > 0.0 ? std::sqrt(v.all / v.within) : HUGE_VAL;
}

/// Geyer's initial monotone sequence of pairs.
double effective(const Chains& chains) {
    const Variances v = variances(chains);
    const std::size_t n = chains.front().size();
    const double total = static_cast<double>(chains.size() * n);
    if (!(v.within > 0.0))
        return 1.0;
    std::vector<double> means;
    for (const auto& chain : chains)
        means.push_back(mean(chain));
    const auto correlation = [&](std::size_t lag) {
        double sum = 0.0;
        for (std::size_t c = 0; c < chains.size(); ++c)
            sum += covariance_at(chains[c], means[c], lag) / static_cast<double>(chains.size());
        return lag == 0
                   ? 1.0
                   : 1.0 - (v.within - sum * static_cast<double>(n) / static_cast<double>(n - 1)) / v.all;
    };
    double time = -1.0, last = HUGE_VAL;
    for (std::size_t lag = 0; lag + 1 < n; lag += 2) {
        const double pair = std::min(last, correlation(lag) + correlation(lag + 1));
        if (!(pair > 0.0))
            break;
        time += 2.0 * pair;
        last = pair;
    }
    return total / std::max(time, 1.0 / std::log10(total));
}

double quantile(const std::vector<double>& sorted, double p) {
    const double at = p * static_cast<double>(sorted.size() - 1);
    const auto i = static_cast<std::size_t>(at);
    return std::lerp(sorted[i], sorted[std::min(i + 1, sorted.size() - 1)], at - static_cast<double>(i));
}

} // namespace

double effective_samples(const std::vector<std::vector<double>>& chains) { return effective(halves(chains)); }

Marginal marginal(const std::vector<std::vector<double>>& chains) {
    std::vector<double> all;
    for (const auto& chain : chains)
        all.insert(all.end(), chain.begin(), chain.end());
    std::ranges::sort(all);
    Marginal m;
    m.mean = mean(all);
    m.sd = std::sqrt(covariance_at(all, m.mean, 0) * static_cast<double>(all.size()) /
                     static_cast<double>(all.size() - 1));
    m.median = quantile(all, 0.5), m.q025 = quantile(all, 0.025), m.q975 = quantile(all, 0.975);
    const Chains split = halves(chains);
    Chains folded = split;
    for (auto& chain : folded)
        for (double& value : chain)
            value = std::abs(value - m.median);
    const Chains ranked = scores(split);
    m.rhat = std::max(rhat(ranked), rhat(scores(folded)));
    m.ess = effective(ranked);
    return m;
}

} // namespace rodwake::fitting
