#include "rodwake/fitting/report.hpp"

#include "estimates.hpp"
#include "rodwake/measure/statistics.hpp"
#include "stationarity.hpp"
#include "words.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

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
            const bool flat = std::isinf(report.estimates[report.free[a]].stderr_) ||
                              std::isinf(report.estimates[report.free[b]].stderr_);
            if (flat)
                report.covariance(a, b) =
                    a == b && std::isinf(report.estimates[report.free[a]].stderr_) ? infinite : 0.0;
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

std::size_t same_optimum(const Fit& fit) {
    return static_cast<std::size_t>(std::ranges::count_if(fit.starts, [&](const StartEnd& s) {
        return std::isfinite(s.objective) && s.objective <= fit.objective * (1.0 + 1e-4) + 1e-8;
    }));
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
    if (!point.finite()) {
        Report report = without_curvature(problem, fit);
        report.remarks = remarks_of(problem, fit, report, 1.0, false);
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
    report.same_optimum = same_optimum(fit);
    report.remarks =
        remarks_of(problem, fit, report, scale.rise, stationarity(evaluator, point).newton <= tiny_change);
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

} // namespace rodwake::fitting
