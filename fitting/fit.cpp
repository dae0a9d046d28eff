#include "rodwake/fitting/fit.hpp"

#include "diagnostics.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/core/rng.hpp"
#include "search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

namespace rodwake::fitting {

namespace {

constexpr std::array names = {"converged", "roundoff", "budget", "interrupted", "failed"};

/// StartResult::termination is "converged: reason".
Termination termination_in(const std::string& words) {
    for (std::size_t i = 0; i < names.size(); ++i)
        if (words.starts_with(names[i]))
            return static_cast<Termination>(i);
    return Termination::failed;
}

/// A search that could not begin (stopped, or no derivatives) leaves the point unchanged.
SearchResult with_levenberg_marquardt(Evaluator& evaluator, const SearchResult& end) {
    SearchResult refined = levenberg_marquardt(evaluator, end.u);
    if (!std::isfinite(refined.objective)) {
        refined.u = end.u;
        refined.objective = end.objective;
        if (refined.termination == Termination::failed)
            refined.termination = end.termination;
    }
    refined.reason = end.reason + "; " + refined.reason;
    return refined;
}

SearchResult search(Evaluator& evaluator, const Method& method, const Eigen::VectorXd& start,
                    std::uint32_t seed) {
    if (start.size() == 0)
        return levenberg_marquardt(evaluator, start);
    SearchResult end = nlopt_search(evaluator, method, start, seed);
    if (!evaluator.found()) {
        if (!evaluator.stopped()) // what NLopt makes of the penalties is of no interest
            end.reason = fmt::format("no finite residuals at any of {} points; at the last: {}",
                                     evaluator.evaluations(), evaluator.trouble());
        return end;
    }
    if (!method.levenberg_marquardt || evaluator.stopped())
        return end;
    SearchResult first = with_levenberg_marquardt(evaluator, end);
    if (is_global(method.algorithm) || evaluator.stopped())
        return first;

    // The better of two ends, since NLopt sees only the sum of squares and may leap over a minimum to which
    // the residuals lead, or the other way round. The first counts unless the second is lower by more than
    // rounding, or as low and alone stationary.
    SearchResult second = levenberg_marquardt(evaluator, start);
    if (evaluator.stopped()) {
        if (evaluator.best() < first.objective) {
            first.u = evaluator.best_u();
            first.objective = evaluator.best();
        }
        first.termination = Termination::interrupted;
        first.reason += "; polish from the start itself: interrupted";
        return first;
    }
    if (!std::isfinite(second.objective)) {
        first.reason += "; from the start itself " + second.reason;
        return first;
    }
    const bool lower = second.objective < first.objective * (1.0 - 1e-13);
    const bool steadier = second.objective <= first.objective * (1.0 + 1e-13) &&
                          second.termination == Termination::converged &&
                          first.termination != Termination::converged;
    const double rise = second.objective - first.objective, same = 1e-6 * first.objective + 1e-8;
    const std::string how = rise > same ? "higher" : rise < -same ? "lower" : "as low";
    if (!lower && !steadier) {
        first.reason += "; the polish from the start itself ends " + how;
        return first;
    }
    second.reason = fmt::format("{}; taken instead: the polish from the start itself, which ends {} ({})",
                                first.reason, how, second.reason);
    return second;
}

StartResult run_start(const Problem& problem, const Method& method, std::size_t index,
                      const std::function<bool()>& stop) {
    const SearchSpace space(problem);
    Evaluator evaluator(problem, space, {method.loss, method.loss_width}, stop);
    StartResult result{index, start_values(problem, method, index), {}, 0.0, {}, 0};
    RandomStream random(method.seed, static_cast<std::uint32_t>(index), 1);
    const SearchResult end =
        search(evaluator, method, space.coordinates(result.start), static_cast<std::uint32_t>(random.bits()));
    evaluator.require_memory();
    result.end = space.free_values(end.u);
    result.objective = end.objective;
    result.termination = to_string(end.termination) + ": " + end.reason;
    result.evaluations = evaluator.evaluations();
    return result;
}

/// Sets chi2 and the distance from stationarity of the best end.
void look_at(const Problem& problem, const Method& method, Fit& fit) {
    std::vector<double> free;
    for (const std::size_t i : free_parameters(problem))
        free.push_back(fit.values[i]);
    const SearchSpace space(problem);
    Evaluator evaluator(problem, space, {method.loss, method.loss_width});
    const SearchPoint point = evaluator(space.coordinates(free), true);
    evaluator.require_memory();
    fit.chi2 = fit.distance = std::numeric_limits<double>::infinity();
    if (!point.finite())
        return;
    fit.chi2 = chi2_of(problem, point.r);
    fit.distance = stationarity(evaluator, point).distance;
    const long dof = degrees_of_freedom(problem);
    if (!problem.sigma_known && fit.distance > 0.0 && dof > 0)
        fit.distance /= std::sqrt(fit.objective / static_cast<double>(dof));
}

} // namespace

std::string to_string(Termination termination) { return names[static_cast<std::size_t>(termination)]; }

Fit fit(const Problem& problem, const Method& method) {
    validate(problem);
    check_method(problem, method);

    // All starts in parallel; those of an earlier run are taken over, and those not begun before a stop stay
    // empty.
    std::vector<std::optional<StartResult>> ends(method.starts);
    for (const StartResult& done : method.done)
        ends[done.index] = done;
    std::mutex mutex;
    bool interrupted = false;
    const auto stopped = [&] {
        if (!method.stop_requested)
            return false;
        const std::lock_guard lock(mutex);
        return interrupted = interrupted || method.stop_requested();
    };
    parallel_for(ends.size(), std::max<std::size_t>(method.threads, 1), [&](std::size_t i) {
        if (ends[i] || stopped())
            return;
        ends[i] = run_start(problem, method, i, stopped);
        const std::lock_guard lock(mutex);
        if (method.on_start_done && termination_in(ends[i]->termination) != Termination::interrupted)
            method.on_start_done(*ends[i]);
    });

    // The best is the first of those that differ by rounding only: with one minimum the end of the user's own
    // start.
    Fit fit;
    fit.loss = method.loss;
    fit.loss_width = method.loss_width;
    for (const auto& end : ends)
        if (end) {
            fit.starts.push_back(*end);
            fit.evaluations += end->evaluations;
        }
    const auto least = std::ranges::min_element(fit.starts, {}, &StartResult::objective);
    const auto best = std::ranges::find_if(fit.starts, [&](const StartResult& end) {
        return !(end.objective > least->objective * (1.0 + 1e-13));
    });
    if (best == fit.starts.end()) {
        fit.values = all_values(problem, start_values(problem, method, 0));
        fit.termination = Termination::interrupted;
        fit.reason = "interrupted before the first start";
        fit.objective = fit.chi2 = fit.distance = std::numeric_limits<double>::infinity();
        return fit;
    }
    fit.values = all_values(problem, best->end);
    fit.objective = best->objective;
    fit.termination = interrupted ? Termination::interrupted : termination_in(best->termination);
    const std::size_t colon = best->termination.find(": ");
    fit.reason = colon == std::string::npos ? best->termination : best->termination.substr(colon + 2);
    look_at(problem, method, fit);
    return fit;
}

bool needs_gradient(Algorithm algorithm) {
    return algorithm == Algorithm::slsqp || algorithm == Algorithm::lbfgs || algorithm == Algorithm::mma;
}

std::string to_string(Algorithm algorithm) {
    switch (algorithm) {
    case Algorithm::bobyqa:
        return "bobyqa";
    case Algorithm::nelder_mead:
        return "nelder-mead";
    case Algorithm::slsqp:
        return "slsqp";
    case Algorithm::lbfgs:
        return "lbfgs";
    case Algorithm::mma:
        return "mma";
    case Algorithm::mlsl:
        return "mlsl";
    case Algorithm::crs:
        return "crs";
    case Algorithm::isres:
        return "isres";
    case Algorithm::direct_l:
        return "direct-l";
    }
    throw InputError("fit: no such algorithm");
}

void check_method(const Problem& problem, const Method& method) {
    if (!(method.tolerance > 0.0 && method.tolerance < 1.0))
        throw InputError(fmt::format("fit: tolerance {}: must be above 0 and below 1", method.tolerance));
    if (method.max_evaluations < 1)
        throw InputError(fmt::format("fit: max_evaluations {}: must be at least 1", method.max_evaluations));
    if (method.starts < 1)
        throw InputError("fit: starts 0: must be at least 1");
    if (!(method.spread > 1.0 && std::isfinite(method.spread)))
        throw InputError(fmt::format("fit: spread {}: must be above 1", method.spread));
    if (!(method.loss_width > 0.0 && std::isfinite(method.loss_width)))
        throw InputError(fmt::format("fit: loss_width {}: must be above 0", method.loss_width));
    const std::size_t free = free_parameters(problem).size();
    for (const StartResult& done : method.done)
        if (done.index >= method.starts || done.end.size() != free || done.start.size() != free)
            throw InputError(
                fmt::format("fit: the finished start {} (of {} parameters) is not one of these {} starts "
                            "of {} parameters: it belongs to another fit",
                            done.index, done.end.size(), method.starts, free));
    for (const Parameter& p : problem.parameters)
        if (is_global(method.algorithm) && p.free() && (!std::isfinite(p.upper) || !std::isfinite(p.lower)))
            throw InputError(
                fmt::format("fit: {} searches the whole box of the bounds, so {} needs a lower and an "
                            "upper bound; or choose a local method such as slsqp with several starts",
                            to_string(method.algorithm), p.name));
}

} // namespace rodwake::fitting
