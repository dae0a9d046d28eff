#include "rodwake/fitting/problem.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

const Parameter* find(const Problem& problem, const std::string& name) {
    const auto found = std::ranges::find(problem.parameters, name, &Parameter::name);
    return found == problem.parameters.end() ? nullptr : &*found;
}

void check_names(const Problem& problem) {
    for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
        const std::string& name = problem.parameters[i].name;
        if (name.empty())
            throw InputError(fmt::format("fit: parameter {} has no name", i));
        if (find(problem, name) != &problem.parameters[i])
            throw InputError(fmt::format("fit: two parameters are called \"{}\"", name));
    }
}

void check_bounds(const Parameter& p) {
    if (std::isnan(p.lower) || std::isnan(p.upper))
        throw InputError(fmt::format("fit: a bound of {} is not a number", p.name));
    if (p.lower > p.upper)
        throw InputError(fmt::format("fit: bounds of {} are reversed: [{}, {}]", p.name, p.lower, p.upper));
    if (p.lower == p.upper)
        throw InputError(
            fmt::format("fit: both bounds of {} are {}: to hold it there, fix it", p.name, p.lower));
    if (p.start < p.lower || p.start > p.upper)
        throw InputError(fmt::format("fit: {} starts at {}, outside its bounds [{}, {}]", p.name, p.start,
                                     p.lower, p.upper));
}

/// A log parameter without a lower bound has the whole positive axis.
void check_log(const Parameter& p) {
    if (p.start <= 0.0)
        throw InputError(fmt::format(
            "fit: {} is searched in the logarithm, so its start must be above 0, not {}", p.name, p.start));
    if (std::isfinite(p.lower) && p.lower <= 0.0)
        throw InputError(
            fmt::format("fit: {} is searched in the logarithm, so its lower bound must be above 0, not {}",
                        p.name, p.lower));
}

void check_free(const Parameter& p) {
    if (!std::isfinite(p.start))
        throw InputError(fmt::format("fit: the start of {} is not a finite number", p.name));
    if (!(p.scale >= 0.0) || !std::isfinite(p.scale))
        throw InputError(
            fmt::format("fit: the scale of {} is {}: must be above 0, or 0 to choose", p.name, p.scale));
    if (!p.free())
        return;
    check_bounds(p);
    if (p.transform == Transform::log)
        check_log(p);
}

void check_tie(const Problem& problem, const Parameter& p) {
    if (p.tied_to.empty())
        return;
    if (p.fixed)
        throw InputError(fmt::format("fit: {} is both fixed and tied to {}: choose one", p.name, p.tied_to));
    const Parameter* to = find(problem, p.tied_to);
    if (!to || !to->free())
        throw InputError(fmt::format("fit: {} is tied to {}, which is {}: must be a free parameter", p.name,
                                     p.tied_to, to ? "not free itself" : "no parameter"));
    if (!std::isfinite(p.tie_factor))
        throw InputError(fmt::format("fit: the factor that ties {} is not a finite number", p.name));
}

} // namespace

void validate(const Problem& problem) {
    check_names(problem);
    for (const Parameter& p : problem.parameters) {
        check_free(p);
        check_tie(problem, p);
    }
    if (!problem.evaluate)
        throw InputError("fit: the problem has no function that gives its residuals");
    if (!(problem.independent > 0.0 && problem.independent <= 1.0))
        throw InputError(
            fmt::format("fit: independent = {}: a residual is worth more than 0 and at most 1 value",
                        problem.independent));
    const std::size_t free = free_parameters(problem).size();
    if (problem.residuals == 0 || problem.residuals < free)
        throw InputError(fmt::format("fit: {} data points cannot fix {} parameters: give more data or fix "
                                     "some of the parameters",
                                     problem.residuals, free));
}

long independent_values(const Problem& problem) {
    return std::lround(problem.independent * static_cast<double>(problem.residuals));
}

long degrees_of_freedom(const Problem& problem) {
    return independent_values(problem) - static_cast<long>(free_parameters(problem).size());
}

std::vector<std::size_t> free_parameters(const Problem& problem) {
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < problem.parameters.size(); ++i)
        if (problem.parameters[i].free())
            free.push_back(i);
    return free;
}

std::vector<double> all_values(const Problem& problem, std::span<const double> free) {
    std::vector<double> values(problem.parameters.size());
    for (std::size_t i = 0, next = 0; i < values.size(); ++i)
        values[i] = problem.parameters[i].free() ? free[next++] : problem.parameters[i].start;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (const Parameter& p = problem.parameters[i]; !p.tied_to.empty())
            values[i] = p.tie_factor * values[find(problem, p.tied_to) - problem.parameters.data()];
    return values;
}

} // namespace rodwake::fitting
