#include "fit_files.hpp"

#include <cmath>

namespace rodwake::app {

namespace {

using fitting::ChainBlock;

fitting::Prior prior_of(const FitPlan& plan, const fitting::Parameter& p) {
    double low = p.lower, high = p.upper;
    if (fitting::is_start_pose(p.name)) { // "x.<track>.<rod>"
        const fitting::Trajectory& track =
            plan.tracks.at(std::stoul(p.name.substr(p.name.find('.') + 1))).data;
        const double sigma = p.name.starts_with("heading") ? track.sigma_heading : track.sigma_position,
                     wide = 10.0 * sigma / std::sqrt(track.independent);
        low = p.start - wide, high = p.start + wide;
    }
    const auto& priors = plan.keys.posterior->priors;
    fitting::Prior prior = priors.contains(p.name) ? priors.at(p.name) : fitting::Prior{};
    prior.low = prior.low.value_or(low), prior.high = prior.high.value_or(high);
    return prior;
}

void log_posterior(const FitPlan& plan, const fitting::Posterior& found, const Logger& log) {
    for (std::size_t k = 0; k < found.free.size(); ++k) {
        const fitting::Marginal& m = found.marginals[k];
        log->info("posterior: {} = {:.6g} +- {:.2g}, 95 % within {:.5g} and {:.5g}; R-hat {:.4f}, {:.0f} "
                  "effective samples",
                  plan.problem.parameters[found.free[k]].name, m.mean, m.sd, m.q025, m.q975, m.rhat, m.ess);
    }
    if (found.log_evidence)
        log->info("posterior: log evidence {:.3f} +- {:.2g}", found.log_evidence->value,
                  found.log_evidence->error);
    for (const std::string& remark : found.remarks)
        log->warn("posterior: {}", remark);
}

} // namespace

std::vector<fitting::Prior> fit_priors(const FitPlan& plan) {
    std::vector<fitting::Prior> priors;
    for (const std::size_t i : fitting::free_parameters(plan.problem))
        priors.push_back(prior_of(plan, plan.problem.parameters[i]));
    return priors;
}

fitting::PosteriorMethod posterior_method(const FitPlan& plan) {
    const scene::FitPosterior& keys = *plan.keys.posterior;
    fitting::PosteriorMethod method;
    method.chains = keys.chains, method.samples = keys.samples, method.evidence = keys.evidence;
    method.seed = plan.method.seed;
    return method;
}

bool add_posterior(const FitPlan& plan, const fitting::Fit& fit, store::Journal& journal,
                   const RunContext& context, const std::filesystem::path& folder, const Logger& log) {
    if (!plan.keys.posterior)
        return true;
    const std::vector<fitting::Prior> priors = fit_priors(plan);
    fitting::PosteriorMethod method = posterior_method(plan);
    method.threads = context.thread_count();
    method.done = journal.all<ChainBlock>();
    std::size_t count = method.done.size();
    if (count > 0)
        log->info("posterior: resuming after {} of {} blocks", count, fitting::block_count(method));
    Progress progress(context, "posterior", static_cast<double>(fitting::block_count(method)), "blocks");
    method.on_block_done = [&](const ChainBlock& block) {
        journal.add(block);
        progress.update(static_cast<double>(++count));
    };
    method.stop_requested = [&] { return context.stopped(); };
    const auto found = fitting::sample(plan.problem, priors, fit.values, method);
    if (!found)
        return false;
    write_posterior(folder, plan, *found, context);
    log_posterior(plan, *found, log);
    return true;
}

} // namespace rodwake::app
