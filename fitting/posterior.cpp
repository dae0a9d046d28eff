#include "rodwake/fitting/posterior.hpp"

#include "prior_map.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/core/rng.hpp"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <mutex>
#include <new>
#include <numbers>

namespace rodwake::fitting {

namespace {

constexpr std::size_t warm_up_blocks = 6;
constexpr std::uint32_t of_start = 0, of_bridge = 1, of_blocks = 2; // substreams of a chain
const double log_root_2pi = 0.5 * std::log(2.0 * std::numbers::pi);

double normal_draw(RandomStream& random) { return normal_quantile(random.uniform()); }

Eigen::VectorXd normal_draws(RandomStream& random, Eigen::Index size) {
    Eigen::VectorXd out(size);
    for (double& one : out)
        one = normal_draw(random);
    return out;
}

/// Density of z, all constants in it.
class Density {
public:
    Density(const Problem& problem, const std::vector<Prior>& priors)
        : problem_(problem), free_(free_parameters(problem)) {
        for (std::size_t k = 0; k < free_.size(); ++k)
            maps_.emplace_back(priors.at(k), problem.parameters[free_[k]].name);
    }

    Eigen::Index size() const { return static_cast<Eigen::Index>(free_.size()); }

    std::vector<double> free_values(const Eigen::VectorXd& z) const {
        std::vector<double> out;
        for (std::size_t k = 0; k < maps_.size(); ++k)
            out.push_back(maps_[k].value(z[static_cast<Eigen::Index>(k)]));
        return out;
    }

    Eigen::VectorXd coordinates(std::span<const double> values) const {
        Eigen::VectorXd z(size());
        for (std::size_t k = 0; k < maps_.size(); ++k)
            z[static_cast<Eigen::Index>(k)] = maps_[k].coordinate(values[free_[k]]);
        return z;
    }

    /// Empty where the model does not exist.
    Eigen::VectorXd residuals(const Eigen::VectorXd& z) const {
        Eigen::VectorXd r = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem_.residuals));
        try {
            problem_.evaluate(all_values(problem_, free_values(z)), r, nullptr);
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception&) { // a place without a model, as in a search
            return {};
        }
        return r.allFinite() ? r : Eigen::VectorXd();
    }

    double at(const Eigen::VectorXd& z) const {
        const Eigen::VectorXd r = residuals(z);
        const double value = r.size() == 0 ? -HUGE_VAL : log_likelihood_of(r.squaredNorm()) + log_prior(z);
        return std::isfinite(value) ? value : -HUGE_VAL;
    }

    double log_prior(const Eigen::VectorXd& z) const {
        return -0.5 * z.squaredNorm() - static_cast<double>(size()) * log_root_2pi;
    }

private:
    double log_likelihood_of(double chi2) const {
        return -0.5 * chi2 - problem_.log_sigmas - static_cast<double>(problem_.residuals) * log_root_2pi;
    }

    const Problem& problem_;
    std::vector<std::size_t> free_;
    std::vector<PriorMap> maps_;
};

struct Peak {
    Eigen::VectorXd z;
    Eigen::MatrixXd covariance;
};

/// By central differences in z, which keeps ties and maps out of it; a step of 1e-4 where z is of order 1.
Eigen::MatrixXd slopes(const Density& density, const Eigen::VectorXd& z, const Eigen::VectorXd& r) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(r.size(), z.size());
    for (Eigen::Index k = 0; k < z.size(); ++k) {
        Eigen::VectorXd up = z, down = z;
        up[k] += 1e-4, down[k] -= 1e-4;
        const Eigen::VectorXd above = density.residuals(up), below = density.residuals(down);
        if (above.size() > 0 && below.size() > 0)
            out.col(k) = (above - below) / 2e-4;
    }
    return out;
}

/// Levenberg-Marquardt on chi2 + |z|^2: the prior makes the curvature positive.
Peak peak(const Density& density, Eigen::VectorXd z) {
    double damping = 1e-3, value = density.at(z);
    Eigen::VectorXd r = density.residuals(z);
    if (r.size() == 0)
        throw RunError("fit.posterior: the model does not exist where the fit ended, within the priors");
    Eigen::MatrixXd curvature;
    for (int step = 0; step < 50; ++step) {
        const Eigen::MatrixXd j = slopes(density, z, r);
        curvature = j.transpose() * j + Eigen::MatrixXd::Identity(z.size(), z.size());
        Eigen::MatrixXd damped = curvature;
        damped.diagonal() *= 1.0 + damping;
        const Eigen::VectorXd change = damped.ldlt().solve(j.transpose() * r + z), next = z - change;
        const double there = density.at(next);
        if (there > value) {
            const bool close = there - value < 1e-6;
            z = next, value = there, r = density.residuals(z), damping *= 0.1;
            if (close)
                break;
        } else if ((damping *= 10.0) > 1e6) {
            break;
        }
    }
    return {z, curvature.inverse()};
}

Eigen::VectorXd vector_of(const std::vector<double>& list) {
    return Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
}

/// Steps of one chain, block by block.
class Chain {
public:
    Chain(const Density& density, const PosteriorMethod& method, std::size_t chain)
        : density_(density), method_(method), chain_(chain) {}

    /// Two standard deviations about the peak, so that chains that do not mix are seen.
    ChainBlock start(const Peak& peak) const {
        RandomStream random(method_.seed, number(), of_start);
        const Eigen::MatrixXd root = peak.covariance.llt().matrixL();
        ChainBlock block;
        block.chain = chain_;
        double spread = 2.0;
        Eigen::VectorXd z;
        do {
            z = peak.z + spread * (root * normal_draws(random, density_.size()));
            block.log_density = density_.at(z);
            spread *= 0.5;
        } while (!std::isfinite(block.log_density) && spread > 1e-9);
        block.z.assign(z.begin(), z.end());
        block.log_scale = std::log(2.38 / std::sqrt(static_cast<double>(density_.size())));
        block.covariance.assign(peak.covariance.data(), peak.covariance.data() + peak.covariance.size());
        return block;
    }

    ChainBlock next(const ChainBlock& from, std::size_t index) const {
        const bool warm = index < warm_up_blocks;
        const std::size_t each = 4 * (from.z.size() + 2), all = method_.samples / method_.chains;
        const std::size_t count =
            warm ? block_samples : std::min(block_samples, all - (index - warm_up_blocks) * block_samples);
        RandomStream random(method_.seed, number(), of_blocks + static_cast<std::uint32_t>(index));
        ChainBlock block = from;
        block.index = index;
        block.kept.clear(), block.kept_density.clear();
        Eigen::VectorXd z = vector_of(from.z);
        const Eigen::MatrixXd root = covariance_of(from).llt().matrixL();
        std::vector<Eigen::VectorXd> seen;
        for (std::size_t i = 0; i < count * each; ++i) {
            step(z, block, root, random, warm ? 1.0 / std::pow(static_cast<double>(i + 1), 0.6) : 0.0);
            if (warm)
                seen.push_back(z);
            else if ((i + 1) % each == 0) {
                block.kept.insert(block.kept.end(), z.begin(), z.end());
                block.kept_density.push_back(block.log_density);
            }
        }
        block.z.assign(z.begin(), z.end());
        if (warm)
            adapt(block, seen);
        return block;
    }

private:
    std::uint32_t number() const { return static_cast<std::uint32_t>(chain_); }

    static Eigen::MatrixXd covariance_of(const ChainBlock& block) {
        const auto d = static_cast<Eigen::Index>(block.z.size());
        return Eigen::Map<const Eigen::MatrixXd>(block.covariance.data(), d, d);
    }

    /// Now and then a far or a short one: for tails and bends that the covariance does not show.
    void step(Eigen::VectorXd& z, ChainBlock& block, const Eigen::MatrixXd& root, RandomStream& random,
              double gain) const {
        const double kind = random.uniform(), factor = kind < 0.1 ? 0.1 : kind < 0.2 ? 3.0 : 1.0;
        const Eigen::VectorXd there =
            z + factor * std::exp(block.log_scale) * (root * normal_draws(random, z.size()));
        const double density = density_.at(there),
                     odds = std::exp(std::min(0.0, density - block.log_density));
        if (random.uniform() < odds) {
            z = there;
            block.log_density = density;
        }
        if (factor == 1.0)
            block.log_scale += gain * (odds - 0.3);
    }

    /// Half of the block's own covariance, half of the one before.
    static void adapt(ChainBlock& block, const std::vector<Eigen::VectorXd>& seen) {
        Eigen::MatrixXd known = covariance_of(block), found = 0.0 * known;
        Eigen::VectorXd middle = 0.0 * seen.front();
        for (const auto& z : seen)
            middle += z / static_cast<double>(seen.size());
        for (const auto& z : seen)
            found += (z - middle) * (z - middle).transpose() / static_cast<double>(seen.size());
        known = 0.5 * (known + found);
        block.covariance.assign(known.data(), known.data() + known.size());
    }

    const Density& density_;
    const PosteriorMethod& method_;
    std::size_t chain_;
};

/// A Gaussian that can be drawn from.
struct Gaussian {
    Eigen::VectorXd middle;
    Eigen::MatrixXd root;

    double log_density(const Eigen::VectorXd& z) const {
        const Eigen::VectorXd u = root.triangularView<Eigen::Lower>().solve(z - middle);
        return -0.5 * u.squaredNorm() - root.diagonal().array().log().sum() -
               static_cast<double>(z.size()) * log_root_2pi;
    }
};

Gaussian gaussian_of(const std::vector<Eigen::VectorXd>& draws) {
    Eigen::VectorXd middle = 0.0 * draws.front();
    for (const auto& z : draws)
        middle += z / static_cast<double>(draws.size());
    Eigen::MatrixXd spread = Eigen::MatrixXd::Identity(middle.size(), middle.size()) * 1e-300;
    for (const auto& z : draws)
        spread += (z - middle) * (z - middle).transpose() / static_cast<double>(draws.size() - 1);
    return {middle, spread.llt().matrixL()};
}

/// All blocks of one chain in order; kept draws as vectors.
struct Draws {
    std::vector<Eigen::VectorXd> z;
    std::vector<double> log_density;
};

/// Ratios of the target to the Gaussian in logarithms: at draws of the Gaussian, and at samples by chain.
struct Ratios {
    std::vector<double> drawn;
    std::vector<std::vector<double>> sampled;
};

rodwake::Estimate bridge(const Ratios& ratios) {
    double n1 = 0.0, shift = -HUGE_VAL;
    for (const auto& chain : ratios.sampled)
        for (const double one : chain)
            shift = std::max(shift, one), n1 += 1.0;
    const auto n2 = static_cast<double>(ratios.drawn.size());
    const double s1 = n1 / (n1 + n2), s2 = 1.0 - s1;
    double log_r = 0.0; // of the evidence over exp(shift)
    std::vector<double> f1(ratios.drawn.size());
    auto f2 = ratios.sampled;
    double top = 0.0, bottom = 0.0;
    for (int round = 0; round < 1000; ++round) {
        top = bottom = 0.0;
        for (std::size_t i = 0; i < f1.size(); ++i) {
            const double x = std::exp(ratios.drawn[i] - shift - log_r);
            top += f1[i] = std::isinf(x) ? 1.0 / s1 : x / (s1 * x + s2);
        }
        for (std::size_t c = 0; c < f2.size(); ++c)
            for (std::size_t i = 0; i < f2[c].size(); ++i)
                bottom += f2[c][i] = 1.0 / (s1 * std::exp(ratios.sampled[c][i] - shift - log_r) + s2);
        const double change = std::log(top / n2) - std::log(bottom / n1);
        log_r += change;
        if (!(std::abs(change) > 1e-10))
            break;
    }
    top /= n2, bottom /= n1;
    double v1 = 0.0, v2 = 0.0;
    for (const double one : f1)
        v1 += (one - top) * (one - top) / (n2 * top * top);
    for (const auto& chain : f2)
        for (const double one : chain)
            v2 += (one - bottom) * (one - bottom) / (n1 * bottom * bottom);
    const double error = std::sqrt(v1 / n2 + (v2 > 0.0 ? v2 / effective_samples(f2) : 0.0));
    return {log_r + shift, error, static_cast<std::size_t>(n2)};
}

std::optional<rodwake::Estimate> evidence(const Density& density, const std::vector<Draws>& chains,
                                          const PosteriorMethod& method) {
    std::vector<Eigen::VectorXd> first;
    Ratios ratios;
    for (const Draws& chain : chains)
        first.insert(first.end(), chain.z.begin(),
                     chain.z.begin() + static_cast<std::ptrdiff_t>(chain.z.size() / 2));
    const Gaussian gaussian = gaussian_of(first);
    for (const Draws& chain : chains) {
        auto& list = ratios.sampled.emplace_back();
        for (std::size_t i = chain.z.size() / 2; i < chain.z.size(); ++i)
            list.push_back(chain.log_density[i] - gaussian.log_density(chain.z[i]));
    }
    ratios.drawn.resize(method.samples);
    std::mutex mutex;
    bool stopped = false;
    const auto stop = [&] {
        const std::lock_guard lock(mutex);
        return stopped = stopped || (method.stop_requested && method.stop_requested());
    };
    parallel_for(method.samples, method.threads, [&](std::size_t i) {
        if (stop())
            return;
        RandomStream random(method.seed, static_cast<std::uint32_t>(i), of_bridge);
        const Eigen::VectorXd z = gaussian.middle + gaussian.root * normal_draws(random, density.size());
        ratios.drawn[i] = density.at(z) - gaussian.log_density(z);
    });
    return stopped ? std::nullopt : std::optional(bridge(ratios));
}

std::optional<std::vector<Draws>> run(const Density& density, const Peak& from,
                                      const PosteriorMethod& method) {
    std::map<std::pair<std::size_t, std::size_t>, const ChainBlock*> done;
    for (const ChainBlock& block : method.done)
        done[{block.chain, block.index}] = &block;
    std::vector<Draws> chains(method.chains);
    const std::size_t blocks = block_count(method) / method.chains;
    std::mutex mutex;
    bool stopped = false;
    parallel_for(method.chains, method.threads, [&](std::size_t c) {
        const Chain chain(density, method, c);
        ChainBlock block = chain.start(from);
        for (std::size_t i = 0; i < blocks; ++i) {
            const auto before = done.find({c, i});
            if (before != done.end())
                block = *before->second;
            else {
                {
                    const std::lock_guard lock(mutex);
                    stopped = stopped || (method.stop_requested && method.stop_requested());
                    if (stopped)
                        return;
                }
                block = chain.next(block, i);
                const std::lock_guard lock(mutex);
                if (method.on_block_done)
                    method.on_block_done(block);
            }
            const std::size_t d = block.z.size();
            for (std::size_t k = 0; k < block.kept_density.size(); ++k) {
                chains[c].z.push_back(
                    vector_of({block.kept.begin() + static_cast<std::ptrdiff_t>(k * d),
                               block.kept.begin() + static_cast<std::ptrdiff_t>((k + 1) * d)}));
                chains[c].log_density.push_back(block.kept_density[k]);
            }
        }
    });
    return stopped ? std::nullopt : std::optional(std::move(chains));
}

void judge(const Problem& problem, Posterior& out) {
    for (std::size_t k = 0; k < out.free.size(); ++k)
        if (const Marginal& m = out.marginals[k]; !(m.rhat < 1.01))
            out.remarks.push_back(fmt::format(
                "the chains of {} do not agree (R-hat {:.3f}, {:.0f} effective samples): take more "
                "samples, or a narrower prior if it has places that the data cannot reach",
                problem.parameters[out.free[k]].name, m.rhat, m.ess));
}

void check(const PosteriorMethod& method, std::size_t free, std::size_t priors) {
    if (free == 0 || priors != free)
        throw InputError(fmt::format("posterior: {} priors for {} free parameters", priors, free));
    if (method.chains < 1 || method.samples % method.chains != 0 || method.samples / method.chains < 8)
        throw InputError(
            fmt::format("posterior: samples = {} must be a multiple of chains = {}, 8 a chain or more",
                        method.samples, method.chains));
}

} // namespace

std::size_t block_count(const PosteriorMethod& method) {
    const std::size_t each = method.samples / method.chains;
    return method.chains * (warm_up_blocks + (each + block_samples - 1) / block_samples);
}

std::optional<Posterior> sample(const Problem& problem, const std::vector<Prior>& priors,
                                std::span<const double> from, const PosteriorMethod& method) {
    validate(problem);
    Posterior out;
    out.free = free_parameters(problem);
    check(method, out.free.size(), priors.size());
    const Density density(problem, priors);
    const auto chains = run(density, peak(density, density.coordinates(from)), method);
    if (!chains)
        return std::nullopt;
    out.values.assign(out.free.size(), std::vector<std::vector<double>>(method.chains));
    out.log_likelihood.resize(method.chains);
    for (std::size_t c = 0; c < method.chains; ++c)
        for (std::size_t i = 0; i < (*chains)[c].z.size(); ++i) {
            const Eigen::VectorXd& z = (*chains)[c].z[i];
            const std::vector<double> values = density.free_values(z);
            for (std::size_t k = 0; k < values.size(); ++k)
                out.values[k][c].push_back(values[k]);
            out.log_likelihood[c].push_back((*chains)[c].log_density[i] - density.log_prior(z));
        }
    for (const auto& values : out.values)
        out.marginals.push_back(marginal(values));
    judge(problem, out);
    if (method.evidence && !(out.log_evidence = evidence(density, *chains, method)))
        return std::nullopt;
    return out;
}

} // namespace rodwake::fitting
