#include "rodwake/fitting/refits.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::fitting {

namespace {

/// Of the deviations from the mean.
std::vector<double> sum_of_squares(const std::vector<std::vector<double>>& values) {
    if (values.size() < 2)
        throw InputError(fmt::format("a spread needs two values or more; there are {}", values.size()));
    std::vector<double> mean(values.front().size(), 0.0), sum = mean;
    for (const auto& item : values)
        for (std::size_t k = 0; k < mean.size(); ++k)
            mean[k] += item[k] / static_cast<double>(values.size());
    for (const auto& item : values)
        for (std::size_t k = 0; k < sum.size(); ++k)
            sum[k] += (item[k] - mean[k]) * (item[k] - mean[k]);
    return sum;
}

std::vector<double> values_at(const std::function<Problem(const std::vector<Parameter>&)>& remake,
                              std::vector<Parameter> parameters, const Method& method,
                              std::span<const double> best, std::size_t held, double value) {
    parameters[held].start = value;
    const Fit fit = refit(remake(parameters), method, best);
    if (fit.termination == Termination::failed || !std::isfinite(fit.chi2))
        throw RunError(fmt::format("fit: no fit with {} = {:g}, within the error of its fixed value: {}",
                                   parameters[held].name, value, fit.reason));
    return fit.values;
}

} // namespace

Fit refit(const Problem& problem, const Method& method, std::span<const double> from) {
    Problem near = problem;
    for (std::size_t i = 0; i < near.parameters.size(); ++i)
        if (near.parameters[i].free())
            near.parameters[i].start = from[i];
    Method once = method;
    once.starts = 1;
    once.threads = 1;
    once.done.clear();
    once.on_start_done = nullptr;
    if (is_global(once.algorithm))
        once.algorithm = Algorithm::slsqp;
    return fit(near, once);
}

std::vector<double> change_with(const std::function<Problem(const std::vector<Parameter>&)>& remake,
                                const std::vector<Parameter>& parameters, const Method& method,
                                std::span<const double> best, const HeldConstant& held) {
    const Parameter& p = parameters.at(held.parameter);
    if (!p.fixed || !(held.error > 0.0) || !std::isfinite(held.error))
        throw InputError(
            fmt::format("fit: {}: only a fixed parameter has an error of its own, above 0", p.name));
    const auto above = values_at(remake, parameters, method, best, held.parameter, p.start + held.error),
               below = values_at(remake, parameters, method, best, held.parameter, p.start - held.error);
    std::vector<double> change;
    for (std::size_t k = 0; k < above.size(); ++k)
        change.push_back(0.5 * (above[k] - below[k]));
    return change;
}

std::vector<double> spread(const std::vector<std::vector<double>>& values) {
    std::vector<double> out = sum_of_squares(values);
    for (double& value : out)
        value = std::sqrt(value / static_cast<double>(values.size() - 1));
    return out;
}

std::vector<double> jackknife_error(const std::vector<std::vector<std::vector<double>>>& values) {
    if (values.empty())
        throw InputError("a jackknife needs runs to leave out");
    std::vector<double> variance;
    for (const auto& group : values) {
        const std::vector<double> squares = sum_of_squares(group);
        variance.resize(squares.size(), 0.0);
        const auto n = static_cast<double>(group.size());
        for (std::size_t k = 0; k < squares.size(); ++k)
            variance[k] += (n - 1.0) / n * squares[k];
    }
    for (double& value : variance)
        value = std::sqrt(value);
    return variance;
}

} // namespace rodwake::fitting
