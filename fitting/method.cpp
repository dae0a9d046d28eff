#include "search.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::fitting {

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

namespace {

void check_done(const Problem& problem, const Method& method) {
    const std::size_t free = free_parameters(problem).size();
    for (const StartResult& done : method.done)
        if (done.index >= method.starts || done.end.size() != free || done.start.size() != free)
            throw InputError(
                fmt::format("fit: the finished start {} (of {} parameters) is not one of these {} starts "
                            "of {} parameters: it belongs to another fit",
                            done.index, done.end.size(), method.starts, free));
}

void check_box(const Problem& problem, const Method& method) {
    for (const Parameter& p : problem.parameters) {
        const bool open = !std::isfinite(p.upper) || !std::isfinite(p.lower);
        if (p.free() && open)
            throw InputError(
                fmt::format("fit: {} searches the whole box of the bounds, so {} needs a lower and an "
                            "upper bound; or choose a local method such as slsqp with several starts",
                            to_string(method.algorithm), p.name));
    }
}

} // namespace

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
    check_done(problem, method);
    if (is_global(method.algorithm))
        check_box(problem, method);
}

} // namespace rodwake::fitting
