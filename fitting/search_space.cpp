#include "search_space.hpp"

#include "rodwake/core/rng.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

double natural_scale(const Parameter& p) {
    if (p.scale > 0.0)
        return p.scale;
    if (p.transform == Transform::log)
        return 1.0;
    if (p.start != 0.0)
        return std::abs(p.start);
    const double width = p.upper - p.lower;
    return std::isfinite(width) ? 0.1 * width : 1.0;
}

SearchSpace::SearchSpace(const Problem& problem) : free(free_parameters(problem)), problem_(&problem) {
    const Eigen::Index n = size();
    scale_.resize(n);
    lower.resize(n);
    upper.resize(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const Parameter& p = parameter(k);
        scale_[k] = natural_scale(p);
        const bool open = logarithmic(k) && !(p.lower > 0.0);
        lower[k] = open ? -infinite : coordinate(k, p.lower);
        upper[k] = coordinate(k, p.upper);
    }
    for (std::size_t i = 0; i < problem.parameters.size(); ++i)
        for (Eigen::Index k = 0; k < n; ++k)
            if (problem.parameters[i].tied_to == parameter(k).name)
                ties_.push_back({i, k, problem.parameters[i].tie_factor});
}

bool SearchSpace::logarithmic(Eigen::Index k) const { return parameter(k).transform == Transform::log; }

bool SearchSpace::scale_known(Eigen::Index k) const {
    const Parameter& p = parameter(k);
    return p.scale > 0.0 || logarithmic(k) || p.start != 0.0 || std::isfinite(p.upper - p.lower);
}

double SearchSpace::coordinate(Eigen::Index k, double value) const {
    return (logarithmic(k) ? std::log(value) : value) / scale_[k];
}

double SearchSpace::value(Eigen::Index k, double u) const {
    const Parameter& p = parameter(k);
    if (u <= lower[k] && lower[k] > -infinite)
        return p.lower;
    if (u >= upper[k] && upper[k] < infinite)
        return p.upper;
    const double x = u * scale_[k];
    return std::clamp(logarithmic(k) ? std::exp(x) : x, p.lower, p.upper);
}

double SearchSpace::slope(Eigen::Index k, double value) const {
    return logarithmic(k) ? value * scale_[k] : scale_[k];
}

Eigen::VectorXd SearchSpace::coordinates(std::span<const double> free_values) const {
    Eigen::VectorXd u(size());
    for (Eigen::Index k = 0; k < size(); ++k)
        u[k] = coordinate(k, free_values[k]);
    return clamp(u);
}

std::vector<double> SearchSpace::free_values(const Eigen::VectorXd& u) const {
    std::vector<double> values(free.size());
    for (Eigen::Index k = 0; k < size(); ++k)
        values[k] = value(k, u[k]);
    return values;
}

std::vector<double> SearchSpace::values(const Eigen::VectorXd& u) const {
    return all_values(*problem_, free_values(u));
}

Eigen::MatrixXd SearchSpace::chain(const Eigen::MatrixXd& in_values, std::span<const double> values) const {
    Eigen::MatrixXd in_u(in_values.rows(), size());
    for (Eigen::Index k = 0; k < size(); ++k)
        in_u.col(k) = in_values.col(free[k]);
    for (const TiedValue& tie : ties_)
        in_u.col(tie.to) += tie.factor * in_values.col(tie.parameter);
    for (Eigen::Index k = 0; k < size(); ++k)
        in_u.col(k) *= slope(k, values[free[k]]);
    return in_u;
}

std::vector<double> start_values(const Problem& problem, const Method& method, std::size_t index) {
    RandomStream random(method.seed, static_cast<std::uint32_t>(index));
    std::vector<double> values;
    for (const std::size_t i : free_parameters(problem)) {
        const Parameter& p = problem.parameters[i];
        if (index == 0 || !p.spreads) {
            values.push_back(p.start);
            continue;
        }
        if (p.start == 0.0) {
            const double reach = method.spread * natural_scale(p);
            const bool box = std::isfinite(p.lower) && std::isfinite(p.upper);
            const double low = box ? p.lower : std::max(p.lower, -reach),
                         high = box ? p.upper : std::min(p.upper, reach);
            values.push_back(std::clamp(random.uniform(low, high), p.lower, p.upper));
            continue;
        }

        // The start times a factor in [1/spread, spread], even in the logarithm, within the bounds. The sign
        // is that of the start, or that of a coin where both are possible.
        const double given = p.start < 0.0 ? -1.0 : 1.0;
        const bool both = p.transform == Transform::linear && p.lower < 0.0 && p.upper > 0.0;
        const double sign = both && random.uniform() < 0.5 ? -given : given;
        const double size = std::abs(p.start);
        const double nearest = sign > 0.0 ? p.lower : -p.upper, farthest = sign > 0.0 ? p.upper : -p.lower;
        const double low = std::max(size / method.spread, nearest),
                     high = std::min(size * method.spread, farthest);
        const double value = low < high ? random.log_uniform(low, high) : low;
        values.push_back(std::clamp(sign * value, p.lower, p.upper));
    }
    return values;
}

} // namespace rodwake::fitting
