#include "rodwake/fitting/report.hpp"

#include "diagnostics.hpp"
#include "rodwake/measure/statistics.hpp"

#include <boost/math/distributions/students_t.hpp>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

/// Errors in coordinates of the search, what they are multiplied by, and how many make the 95 % interval.
struct Errors {
    const SearchSpace& space;
    const Curvature& curvature;
    double factor, quantile;
};

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
    e.standard_error = product(errors.space.slope(k, e.value), error);
    if (error == 0.0)
        return;
    e.low = shifted(errors.space, k, e.value, -errors.quantile * error);
    e.high = shifted(errors.space, k, e.value, errors.quantile * error);
}

/// Of a parameter on a bound: the interval to the side that is free.
void set_one_sided(const Problem& problem, const Fit& fit, std::size_t i, Estimate& e) {
    if (!e.at_lower && !e.at_upper)
        return;
    const Parameter& p = problem.parameters[i];
    const auto limit = one_sided_limit(problem, fit, i);
    if (e.at_lower)
        e.high = limit.value_or(p.upper);
    else
        e.low = limit.value_or(p.lower);
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
        e.standard_error = product(std::abs(p.tie_factor), to.standard_error);
        e.low = product(p.tie_factor, p.tie_factor < 0.0 ? to.high : to.low);
        e.high = product(p.tie_factor, p.tie_factor < 0.0 ? to.low : to.high);
    }
}

/// Of 95 %: normal, or Student's t.
double quantile95(bool normal, long dof) {
    if (normal)
        return 1.959964;
    if (dof <= 0)
        return infinite;
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
        set_one_sided(problem, fit, i, estimates[i]);
    }
    follow_ties(problem, estimates);
    return estimates;
}

/// Covariance and correlation in values, NaN-free.
void set_matrices(Report& report, const Fit& fit, const Errors& errors) {
    const Eigen::Index n = errors.space.size();
    Eigen::VectorXd slope(n);
    for (Eigen::Index k = 0; k < n; ++k)
        slope[k] = errors.space.slope(k, fit.values[errors.space.free()[k]]);
    const Curvature& c = errors.curvature;
    const double factor = std::isfinite(errors.factor) ? errors.factor : 0.0;
    report.root = factor * (slope.asDiagonal() * c.root);
    report.null_space = slope.asDiagonal() * c.directions.rightCols(c.directions.cols() - c.rank);
    report.covariance = report.root * report.root.transpose();
    report.correlation = Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd error = report.covariance.diagonal().cwiseSqrt();
    for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index b = 0; b < n; ++b) {
            const bool flat = std::isinf(report.estimates[report.free[a]].standard_error) ||
                              std::isinf(report.estimates[report.free[b]].standard_error);
            if (flat)
                report.covariance(a, b) =
                    a == b && std::isinf(report.estimates[report.free[a]].standard_error) ? infinite : 0.0;
            else if (a != b && error[a] > 0.0 && error[b] > 0.0)
                report.correlation(a, b) =
                    std::clamp(report.covariance(a, b) / (error[a] * error[b]), -1.0, 1.0);
        }
}

/// Nothing is known of the errors where the residuals are not finite.
Report without_curvature(const Problem& problem, const Fit& fit) {
    Report report;
    report.free = free_parameters(problem);
    for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
        const Parameter& p = problem.parameters[i];
        const double error = p.fixed ? 0.0 : infinite;
        const double value = fit.values[i];
        report.estimates.push_back({p.name, value, error, p.fixed ? value : -infinite,
                                    p.fixed ? value : infinite, p.free(), false, false, p.tied_to,
                                    p.tie_factor});
    }
    const auto n = static_cast<Eigen::Index>(report.free.size());
    report.covariance = Eigen::MatrixXd::Zero(n, n);
    report.covariance.diagonal().setConstant(infinite);
    report.correlation = Eigen::MatrixXd::Identity(n, n);
    report.root = Eigen::MatrixXd::Zero(n, 0);
    report.null_space = Eigen::MatrixXd::Identity(n, n);
    report.chi2 = infinite;
    report.probability = 0.0;
    report.dof = degrees_of_freedom(problem);
    report.error_factor = infinite;
    return report;
}

std::size_t same_optimum(const Fit& fit, const Report& report) {
    return static_cast<std::size_t>(std::ranges::count_if(
        fit.starts, [&](const StartResult& start) { return at_the_best(fit, report, start); }));
}

std::vector<double> free_values(const Fit& fit, const SearchSpace& space) {
    std::vector<double> values;
    for (const std::size_t i : space.free())
        values.push_back(fit.values[i]);
    return values;
}

} // namespace

Report report(const Problem& problem, const Fit& fit, const ReportOptions& options) {
    const SearchSpace space(problem);
    const LossShape loss{fit.loss, fit.loss_width};
    Evaluator evaluator(problem, space, loss);
    const Point point = evaluator(space.coordinates(free_values(fit, space)), true);
    evaluator.require_memory();
    if (!point.finite()) {
        Report report = without_curvature(problem, fit);
        report.diagnostics = diagnostics_of(problem, fit, report, 1.0, false);
        return report;
    }
    const Curvature c = curvature(space, point, evaluator.gradient(point), options.rank_tolerance);
    Report report;
    report.free = space.free();
    report.rank = c.rank;
    report.chi2 = point.r.squaredNorm();
    report.dof = degrees_of_freedom(problem);
    const ErrorScale scale = error_scale(problem, loss, point, report.dof);
    report.error_factor = scale.factor;
    if (problem.sigma_known && report.dof > 0)
        report.probability = measure::chi2_probability(report.chi2, report.dof);
    const bool normal = problem.sigma_known && fit.loss == Loss::squares;
    const Errors errors{space, c, scale.factor, quantile95(normal, report.dof)};
    report.estimates = estimates_of(problem, fit, errors);
    set_matrices(report, fit, errors);
    report.flat = flat_directions(problem, fit, space, c);
    report.same_optimum = same_optimum(fit, report);
    report.diagnostics = diagnostics_of(problem, fit, report, scale.rise,
                                        stationarity(evaluator, point).newton <= tiny_change);
    return report;
}

Eigen::VectorXd propagated(const Report& report, const Eigen::MatrixXd& gradients) {
    Eigen::MatrixXd g(gradients.rows(), static_cast<Eigen::Index>(report.free.size()));
    for (Eigen::Index k = 0; k < g.cols(); ++k) {
        g.col(k) = gradients.col(report.free[k]);
        const Estimate& to = report.estimates[report.free[k]];
        for (std::size_t i = 0; i < report.estimates.size(); ++i)
            if (report.estimates[i].tied_to == to.name)
                g.col(k) += report.estimates[i].tie_factor * gradients.col(i);
    }
    Eigen::VectorXd errors = (g * report.root).rowwise().norm();
    const Eigen::MatrixXd along = g * report.null_space, size = g.cwiseAbs() * report.null_space.cwiseAbs();
    for (Eigen::Index i = 0; i < errors.size(); ++i)
        if ((along.row(i).array().abs() > 1e-6 * size.row(i).array()).any() ||
            std::isinf(report.error_factor))
            errors[i] = infinite;
    return errors;
}

bool at_bound(const Report& report, const Estimate& estimate) {
    const auto to = std::ranges::find(report.estimates, estimate.tied_to, &Estimate::name);
    const Estimate& e = to == report.estimates.end() ? estimate : *to;
    return e.at_lower || e.at_upper;
}

bool has_error(const Report& report, const Estimate& estimate) {
    return (estimate.free || !estimate.tied_to.empty()) && !at_bound(report, estimate);
}

std::optional<double> fitted_value(const Report& report, const std::string& name) {
    const auto at = std::ranges::find(report.estimates, name, &Estimate::name);
    return at == report.estimates.end() ? std::nullopt : std::optional(at->value);
}

rodwake::Estimate derived(const Report& report, double value, const std::map<std::string, double>& gradient) {
    Eigen::MatrixXd row = Eigen::MatrixXd::Zero(1, static_cast<Eigen::Index>(report.estimates.size()));
    bool any = false, held = false;
    for (std::size_t i = 0; i < report.estimates.size(); ++i)
        if (const auto at = gradient.find(report.estimates[i].name); at != gradient.end()) {
            row(0, static_cast<Eigen::Index>(i)) = at->second;
            any = any || has_error(report, report.estimates[i]);
            held = held || at_bound(report, report.estimates[i]);
        }
    const long values = std::max(0L, report.dof + static_cast<long>(report.free.size()));
    const bool known = any && !held && !std::isinf(report.error_factor);
    return {value, known ? propagated(report, row)[0] : unknown_error, static_cast<std::size_t>(values)};
}

} // namespace rodwake::fitting
