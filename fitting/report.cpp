#include "rodwake/fitting/report.hpp"

#include "diagnostics.hpp"
#include "rodwake/measure/statistics.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

/// Errors in coordinates of the search, what they are multiplied by, and how many make the 95 % interval.
struct CurvatureErrors {
    const SearchSpace& space;
    const Curvature& curvature;
    double factor, quantile;
};

/// 0 * infinity is 0 here: no error times any factor is none.
double product(double a, double b) { return a == 0.0 || b == 0.0 ? 0.0 : a * b; }

std::vector<ParameterEstimate> estimates_of(const Problem& problem, const Fit& fit,
                                            const CurvatureErrors& errors) {
    std::vector<ParameterEstimate> estimates;
    for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
        ParameterEstimate e;
        e.name = problem.parameters[i].name;
        e.value = e.low = e.high = fit.values[i];
        e.free = problem.parameters[i].free();
        estimates.push_back(e);
    }
    for (Eigen::Index k = 0; k < errors.space.size(); ++k) {
        const std::size_t i = errors.space.free[k];
        const Parameter& p = problem.parameters[i];
        ParameterEstimate& e = estimates[i];
        if (errors.curvature.held[k]) {
            // On a bound the interval reaches to the side that is free.
            e.at_lower = e.value - p.lower <= p.upper - e.value;
            e.at_upper = !e.at_lower;
            const auto limit = one_sided_limit(problem, fit, i);
            (e.at_lower ? e.high : e.low) = limit.value_or(e.at_lower ? p.upper : p.lower);
            continue;
        }
        const double error = product(errors.curvature.standard_error[k], errors.factor);
        e.standard_error = product(errors.space.slope(k, e.value), error);
        if (error == 0.0)
            continue;
        // Logarithms turn a shift beyond the doubles into the end of the axis.
        const bool log = errors.space.logarithmic(k);
        const double shift = errors.space.slope(k, log ? 1.0 : e.value) * (errors.quantile * error);
        e.low = log ? e.value * std::exp(-shift) : e.value - shift;
        e.high = log ? e.value * std::exp(shift) : e.value + shift;
    }
    for (std::size_t i = 0; i < estimates.size(); ++i) {
        const Parameter& p = problem.parameters[i];
        if (p.tied_to.empty())
            continue;
        ParameterEstimate& e = estimates[i];
        const ParameterEstimate& to = *std::ranges::find(estimates, p.tied_to, &ParameterEstimate::name);
        e.tied_to = p.tied_to;
        e.tie_factor = p.tie_factor;
        e.standard_error = product(std::abs(p.tie_factor), to.standard_error);
        e.low = product(p.tie_factor, p.tie_factor < 0.0 ? to.high : to.low);
        e.high = product(p.tie_factor, p.tie_factor < 0.0 ? to.low : to.high);
    }
    return estimates;
}

/// Covariance and correlation in values, NaN-free.
void set_matrices(Report& report, const Fit& fit, const CurvatureErrors& errors) {
    const Eigen::Index n = errors.space.size();
    Eigen::VectorXd slope(n);
    for (Eigen::Index k = 0; k < n; ++k)
        slope[k] = errors.space.slope(k, fit.values[errors.space.free[k]]);
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

} // namespace

Report report(const Problem& problem, const Fit& fit, const ReportOptions& options) {
    const SearchSpace space(problem);
    const LossShape loss{fit.loss, fit.loss_width};
    Evaluator evaluator(problem, space, loss);
    std::vector<double> values;
    for (const std::size_t i : space.free)
        values.push_back(fit.values[i]);
    const SearchPoint point = evaluator(space.coordinates(values), true);
    evaluator.require_memory();
    if (!point.finite()) {
        Report report = without_curvature(problem, fit);
        report.diagnostics = diagnostics_of(problem, fit, report, 1.0, false);
        return report;
    }
    const Curvature c = curvature(space, point, evaluator.gradient(point), options.rank_tolerance);
    Report report;
    report.free = space.free;
    report.rank = c.rank;
    report.chi2 = chi2_of(problem, point.r);
    report.dof = degrees_of_freedom(problem);
    const ErrorScale scale = error_scale(problem, loss, point, report.dof);
    report.error_factor = scale.factor;
    if (problem.sigma_known && report.dof > 0)
        report.probability = measure::chi2_probability(report.chi2, report.dof);
    const bool normal = problem.sigma_known && fit.loss == Loss::squares;
    const double quantile95 = // normal, or Student's t
        normal ? 1.959964
        : report.dof <= 0
            ? infinite
            : boost::math::quantile(boost::math::students_t(static_cast<double>(report.dof)), 0.975);
    const CurvatureErrors errors{space, c, scale.factor, quantile95};
    report.estimates = estimates_of(problem, fit, errors);
    set_matrices(report, fit, errors);
    report.flat = flat_directions(problem, fit, space, c);
    for (const StartResult& start : fit.starts)
        report.same_optimum += at_the_best(fit, report, start) ? 1 : 0;
    report.diagnostics = diagnostics_of(problem, fit, report, scale.rise,
                                        stationarity(evaluator, point).newton <= tiny_change);
    return report;
}

Eigen::VectorXd propagated(const Report& report, const Eigen::MatrixXd& gradients) {
    Eigen::MatrixXd g(gradients.rows(), static_cast<Eigen::Index>(report.free.size()));
    for (Eigen::Index k = 0; k < g.cols(); ++k) {
        g.col(k) = gradients.col(report.free[k]);
        const ParameterEstimate& to = report.estimates[report.free[k]];
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

bool at_bound(const Report& report, const ParameterEstimate& estimate) {
    const auto to = std::ranges::find(report.estimates, estimate.tied_to, &ParameterEstimate::name);
    const ParameterEstimate& e = to == report.estimates.end() ? estimate : *to;
    return e.at_lower || e.at_upper;
}

bool has_error(const Report& report, const ParameterEstimate& estimate) {
    return (estimate.free || !estimate.tied_to.empty()) && !at_bound(report, estimate);
}

std::optional<double> fitted_value(const Report& report, const std::string& name) {
    const auto at = std::ranges::find(report.estimates, name, &ParameterEstimate::name);
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

// The report as a page.

namespace {

/// Value and error with as many decimals as two digits of the error need.
std::string with_error(double value, double error, bool known) {
    if (!known && error != 0.0)
        return fmt::format("{:.6g}, error unknown", value);
    if (!std::isfinite(error))
        return fmt::format("{:.6g} +- infinite", value);
    if (error <= 0.0)
        return fmt::format("{:.8g}", value);
    const int of_error = static_cast<int>(std::floor(std::log10(error)));
    const int of_value = value == 0.0 ? of_error : static_cast<int>(std::floor(std::log10(std::abs(value))));
    if (std::max(of_error, of_value) > 6 || std::max(of_error, of_value) < -4)
        return fmt::format("{:.{}e} +- {:.1e}", value, std::clamp(of_value - of_error + 1, 1, 16), error);
    const int decimals = std::clamp(1 - of_error, 0, 17);
    return fmt::format("{:.{}f} +- {:.{}f}", value, decimals, error, decimals);
}

std::string interval(double low, double high) { return fmt::format("[{:.5g}, {:.5g}]", low, high); }

using Row = std::vector<std::string>;

std::string table(const std::vector<Row>& rows) {
    std::vector<std::size_t> width(rows.front().size());
    for (const Row& row : rows)
        for (std::size_t c = 0; c < row.size(); ++c)
            width[c] = std::max(width[c], row[c].size());
    std::string text;
    for (const Row& row : rows) {
        std::string line = " ";
        for (std::size_t c = 0; c < row.size(); ++c)
            line += fmt::format(" {:<{}} ", row[c], width[c]);
        text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return text;
}

std::string estimates(const Problem& problem, const Report& report) {
    std::vector<Row> rows{{"parameter", "value +- error", "95 % interval", "start", "bounds", ""}};
    for (std::size_t i = 0; i < report.estimates.size(); ++i) {
        const ParameterEstimate& e = report.estimates[i];
        const Parameter& p = problem.parameters[i];
        const bool known = std::isfinite(report.error_factor), below = std::isfinite(p.lower),
                   above = std::isfinite(p.upper);
        const std::string bounds = !p.free()        ? ""
                                   : below && above ? interval(p.lower, p.upper)
                                   : below          ? fmt::format(">= {:.5g}", p.lower)
                                   : above          ? fmt::format("<= {:.5g}", p.upper)
                                                    : "";
        const std::string kind = p.fixed              ? "fixed"
                                 : !e.tied_to.empty() ? fmt::format("{:g} {}", e.tie_factor, e.tied_to)
                                 : e.at_lower         ? "on lower bound"
                                 : e.at_upper         ? "on upper bound"
                                 : p.transform == Transform::log ? "log"
                                                                 : "";
        rows.push_back({e.name, with_error(e.value, e.standard_error, known),
                        known && e.low < e.high ? interval(e.low, e.high) : "",
                        e.tied_to.empty() ? fmt::format("{:.5g}", p.start) : "", bounds, kind});
    }
    return table(rows);
}

std::string correlations(const Problem& problem, const Report& report) {
    if (report.free.size() < 2)
        return {};
    constexpr std::size_t most = 12; // parameters with which starts of tracks are shown too
    std::vector<Row> rows{{""}};
    std::string strong;
    for (std::size_t a = 0; a < report.free.size(); ++a) {
        if (report.free.size() > most && !problem.parameters[report.free[a]].spreads)
            break; // the rest are poses
        rows.front().push_back(report.estimates[report.free[a]].name);
        Row row{report.estimates[report.free[a]].name};
        for (std::size_t b = 0; b <= a; ++b) {
            const double c = report.correlation(a, b);
            row.push_back(fmt::format("{:.3f}", c));
            if (a != b && std::abs(c) > 0.9)
                strong += fmt::format("  {} and {} are strongly correlated ({:.4f})\n",
                                      report.estimates[report.free[b]].name,
                                      report.estimates[report.free[a]].name, c);
        }
        rows.push_back(row);
    }
    return "\nCorrelations\n" + table(rows) + strong;
}

/// The waterfall: objectives from the best up, at most ten.
std::string starts(const Fit& fit, const Report& report) {
    if (fit.starts.size() < 2)
        return {};
    std::vector<StartResult> sorted = fit.starts;
    std::ranges::stable_sort(sorted, {}, &StartResult::objective);
    std::string text =
        fmt::format("\nStarts: {} of {} ended at the best objective\n", report.same_optimum, sorted.size());
    std::vector<Row> rows{{"start", "objective", "above the best", "evaluations", "ended"}};
    for (std::size_t i = 0; i < std::min<std::size_t>(sorted.size(), 10); ++i) {
        const StartResult& s = sorted[i];
        const double above =
            std::isfinite(s.objective) ? std::max(s.objective - fit.objective, 0.0) : s.objective;
        rows.push_back({fmt::format("{}", s.index), fmt::format("{:.8g}", s.objective),
                        fmt::format("{:.3g}", above), fmt::format("{}", s.evaluations),
                        s.termination.substr(0, s.termination.find(':'))});
    }
    text += table(rows);
    return text + (sorted.size() > 10 ? fmt::format("  and {} more\n", sorted.size() - 10) : "");
}

} // namespace

std::string to_text(const Problem& problem, const Fit& fit, const Report& report) {
    std::string text = fmt::format("\nchi2 = {:.6g}, {} data", report.chi2, data_count(problem));
    if (problem.independent < 1.0)
        text += fmt::format(" worth {} independent ones", independent_values(problem));
    text += fmt::format(", {} degrees of freedom", report.dof);
    if (report.dof > 0)
        text += fmt::format(", chi2/dof = {:.4g}", report.chi2 / static_cast<double>(report.dof));
    if (problem.sigma_known && report.dof > 0)
        text += ", probability " + describe_probability(report.probability);
    if (fit.loss != Loss::squares)
        text += fmt::format("\nobjective of the loss = {:.6g}", fit.objective);
    text += fmt::format("\n{} after {} evaluations; {}\n", to_string(fit.termination), fit.evaluations,
                        fit.reason) +
            starts(fit, report);
    if (!report.diagnostics.empty())
        text += "\nRemarks\n";
    for (const std::string& remark : report.diagnostics)
        text += "  - " + remark + "\n";
    return estimates(problem, report) + correlations(problem, report) + text;
}

} // namespace rodwake::fitting
