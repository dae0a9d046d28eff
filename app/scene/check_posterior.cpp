#include "check.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::scene {

using fitting::PriorKind;

void check_posterior(const Fit& fit, const Report& report) {
    if (!fit.posterior)
        return;
    const FitPosterior& posterior = *fit.posterior;
    for (const auto& [name, prior] : posterior.priors) {
        const std::string path = "fit.posterior.priors." + name;
        const auto bounds = fit_bounds(fit, name);
        const double least = bounds ? bounds->low : -HUGE_VAL, most = bounds ? bounds->high : HUGE_VAL,
                     low = prior.low.value_or(least), high = prior.high.value_or(most);
        if (!fit_is_free(fit, name))
            report(path, fmt::format("{} is not in fit.parameters: only what is fitted has a prior", name));
        else if (!(low < high))
            report(path, fmt::format("low = {:g} must be below high = {:g}", low, high));
        else if (low < least || high > most)
            report(path,
                   fmt::format(
                       "[{:g}, {:g}] reaches beyond the bounds of {}, [{:g}, {:g}]: make it narrower, or "
                       "fit.bounds.{} wider",
                       low, high, name, least, most, name));
        else if (prior.kind == PriorKind::normal && !(prior.sd > 0.0))
            report(path, fmt::format("sd = {:g}: a normal prior needs mean, and sd above 0", prior.sd));
        else if (prior.kind != PriorKind::normal && !(std::isfinite(low) && std::isfinite(high)))
            report(path, fmt::format("{0}: a {1} prior needs low and high, because fit.bounds.{0} is not set",
                                     name, prior.kind == PriorKind::log_uniform ? "log_uniform" : "uniform"));
        else if (prior.kind == PriorKind::log_uniform && !(low > 0.0))
            report(path, fmt::format("low = {:g}: log_uniform needs low above 0", low));
    }
    for (const std::string& name : fit.parameters)
        if (!posterior.priors.contains(name) && !fit_bounds(fit, name))
            report("fit.posterior",
                   fmt::format("{0} has neither bounds nor a prior, so its posterior cannot be normalised: "
                               "give fit.bounds.{0} or fit.posterior.priors.{0}",
                               name));
    if (posterior.samples % posterior.chains != 0 || posterior.samples / posterior.chains < 8)
        report("fit.posterior.samples",
               fmt::format("samples = {} must be a multiple of chains = {}, with 8 or more per chain",
                           posterior.samples, posterior.chains));
    if (fit.search.loss != fitting::Loss::squares)
        report("fit.loss", "a posterior needs Gaussian errors: loss = \"squares\"");
}

} // namespace rodwake::scene
