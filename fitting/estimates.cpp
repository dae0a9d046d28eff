#include "estimates.hpp"

#include <boost/math/distributions/students_t.hpp>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

/// 0 * infinity is 0 here: no error times any factor is none.
double product(double a, double b) { return a == 0.0 || b == 0.0 ? 0.0 : a * b; }

/// Value at u + shift; beyond the doubles at the end of the axis.
double shifted(const SearchSpace& space, Eigen::Index k, double value, double shift) {
    if (!space.logarithmic(k))
        return value + space.slope(k, value) * shift;
    return value * std::exp(space.slope(k, 1.0) * shift);
}

void set_free(Estimate& e, Eigen::Index k, const Errors& errors, const Parameter& p) {
    if (errors.curvature.held[k]) {
        e.at_lower = e.value - p.lower <= p.upper - e.value;
        e.at_upper = !e.at_lower;
        return;
    }
    const double error = product(errors.curvature.standard_error[k], errors.factor);
    e.stderr_ = product(errors.space.slope(k, e.value), error);
    if (error == 0.0)
        return;
    e.low = shifted(errors.space, k, e.value, -errors.quantile * error);
    e.high = shifted(errors.space, k, e.value, errors.quantile * error);
}

void follow_ties(const Problem& problem, std::vector<Estimate>& estimates) {
    for (std::size_t i = 0; i < estimates.size(); ++i) {
        const Parameter& p = problem.parameters[i];
        if (p.tied_to.empty())
            continue;
        Estimate& e = estimates[i];
        const Estimate& to = *std::ranges::find(estimates, p.tied_to, &Estimate::name);
        e.tied_to = p.tied_to;
        e.tie_factor = p.tie_factor;
        e.stderr_ = product(std::abs(p.tie_factor), to.stderr_);
        e.low = product(p.tie_factor, p.tie_factor < 0.0 ? to.high : to.low);
        e.high = product(p.tie_factor, p.tie_factor < 0.0 ? to.low : to.high);
    }
}

} // namespace

double quantile95(bool normal, long dof) {
    if (normal)
        return 1.959964;
    if (dof <= 0)
        return std::numeric_limits<double>::infinity();
    return boost::math::quantile(boost::math::students_t(static_cast<double>(dof)), 0.975);
}

std::vector<Estimate> estimates_of(const Problem& problem, const Fit& fit, const Errors& errors) {
    std::vector<Estimate> estimates;
    for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
        Estimate e;
        e.name = problem.parameters[i].name;
        e.value = e.low = e.high = fit.values[i];
        e.free = problem.parameters[i].free();
        estimates.push_back(e);
    }
    for (Eigen::Index k = 0; k < errors.space.size(); ++k) {
        const std::size_t i = errors.space.free()[k];
        set_free(estimates[i], k, errors, problem.parameters[i]);
    }
    follow_ties(problem, estimates);
    return estimates;
}

} // namespace rodwake::fitting
