#include "rodwake/fitting/posterior.hpp"

#include "chains.hpp"
#include "prior_map.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

/// Part of the prior that lies between its end and a quantile of the samples: `sorted` are normal under it.
double part_of_prior(const std::vector<double>& sorted, double p, bool lower) {
    const auto at = static_cast<std::size_t>(p * static_cast<double>(sorted.size() - 1));
    return normal_below(lower ? sorted[at] : -sorted[sorted.size() - 1 - at]);
}

/// z: of one parameter, normal under its prior.
void judge_prior(const std::string& name, const Prior& prior, std::vector<double> z, Posterior& out) {
    std::ranges::sort(z);
    for (const bool lower : {true, false}) {
        const char* end = lower ? "lower" : "upper";
        const double median = part_of_prior(z, 0.5, lower),
                     width = part_of_prior(z, 0.975, lower) - part_of_prior(z, 0.025, lower);
        if (!(lower ? prior.low : prior.high)) { // a normal prior has a tail there, which no end cuts off
            if (median < 0.005)
                return out.remarks.push_back(fmt::format(
                    "{} lies in the {} tail of its normal prior: the data want it {} than the prior "
                    "expects; make its sd larger, or mistrust the model",
                    name, end, lower ? "less" : "more"));
            continue;
        }
        // half a normal distribution that begins at the end has 0.3, one that is whole and far from it more
        if (median < 0.3 * width && width < 0.7)
            return out.remarks.push_back(fmt::format(
                "{0} lies against the {1} end of its prior: the data want it {2}; make the prior wider (if "
                "it is a bound's, fit.bounds.{0}), or mistrust the model",
                name, end, lower ? "less" : "more"));
        if (median < 1e-3)
            return out.remarks.push_back(fmt::format(
                "{0} lies in the {1} {2:.1g} of its prior: one that reaches less far would be nearer "
                "to what was known before, and raise the log evidence by up to {3:.1f}; give "
                "fit.posterior.priors.{0}",
                name, lower ? "lowest" : "highest", median, -std::log(2.0 * median)));
    }
    if (part_of_prior(z, 0.975, true) - part_of_prior(z, 0.025, true) > 0.9)
        out.remarks.push_back(fmt::format("the data hardly constrain {}: its posterior is its prior", name));
}

void judge(const Problem& problem, const std::vector<Prior>& priors, const std::vector<Draws>& chains,
           Posterior& out) {
    std::vector<std::string> names;
    for (const std::size_t i : out.free)
        names.push_back(problem.parameters[i].name);
    for (std::size_t c = 0; c < out.accepted.size(); ++c)
        if (out.accepted[c] < 0.01)
            out.remarks.push_back(
                fmt::format("chain {} is stuck: it took {:.2g} % of its steps; the model may not exist in "
                            "most of the prior's range: make the priors narrower",
                            c, 100.0 * out.accepted[c]));
    for (std::size_t k = 0; k < names.size(); ++k)
        if (const Marginal& m = out.marginals[k]; !(m.rhat < 1.01))
            out.remarks.push_back(fmt::format(
                "the chains of {} do not agree (R-hat {:.3f}, {:.0f} effective samples), and its numbers are "
                "not to be trusted: take more samples, or a narrower prior if there are regions that the "
                "chains seldom reach",
                names[k], m.rhat, m.ess));
    if (out.log_evidence && !(out.log_evidence->error < 0.5))
        out.remarks.push_back(fmt::format("the log evidence is known to {:.2g} only: take more samples",
                                          out.log_evidence->error));
    for (std::size_t k = 0; k < names.size(); ++k) {
        std::vector<double> z;
        for (const Draws& chain : chains)
            for (const Eigen::VectorXd& vector : chain.z)
                z.push_back(vector[static_cast<Eigen::Index>(k)]);
        judge_prior(names[k], priors[k], std::move(z), out);
    }
}

} // namespace

std::optional<Posterior> sample(const Problem& problem, const std::vector<Prior>& priors,
                                std::span<const double> from, const PosteriorMethod& method) {
    validate(problem);
    Posterior out;
    out.free = free_parameters(problem);
    if (method.chains < 1 || method.samples % method.chains != 0 || method.samples / method.chains < 8)
        throw InputError(
            fmt::format("posterior: samples = {} must be a multiple of chains = {}, with 8 or more per chain",
                        method.samples, method.chains));
    const Density density(problem, priors);
    if (out.free.empty()) {
        // A model without free parameters has nothing to sample: its evidence is its likelihood.
        Posterior certain;
        const double value = density.log_likelihood({});
        certain.log_likelihood.assign(method.chains,
                                      std::vector<double>(method.samples / method.chains, value));
        certain.accepted.assign(method.chains, 1.0);
        if (method.evidence)
            certain.log_evidence = {value, 0.0, method.samples};
        return certain;
    }
    if (method.stop_requested && method.stop_requested())
        return std::nullopt;
    const Mixture start = peaks(density, density.coordinates(from), method);
    const auto chains = run_chains(density, start, method);
    if (!chains)
        return std::nullopt;
    out.values.assign(out.free.size(), std::vector<std::vector<double>>(chains->draws.size()));
    out.log_likelihood.resize(chains->draws.size());
    for (std::size_t c = 0; c < chains->draws.size(); ++c) {
        for (std::size_t i = 0; i < chains->draws[c].z.size(); ++i) {
            const Eigen::VectorXd& z = chains->draws[c].z[i];
            const std::vector<double> values = density.values(z);
            for (std::size_t k = 0; k < values.size(); ++k)
                out.values[k][c].push_back(values[k]);
            out.log_likelihood[c].push_back(chains->draws[c].log_density[i] - density.log_prior_at(z));
        }
        out.accepted.push_back(chains->draws[c].accepted);
    }
    for (const auto& values : out.values)
        out.marginals.push_back(marginal(values));
    if (method.evidence && !(out.log_evidence = evidence(density, *chains, method)))
        return std::nullopt;
    judge(problem, priors, chains->draws, out);
    return out;
}

} // namespace rodwake::fitting
