// What a report says in sentences: directions the data do not fix, and what else a reader should know.

#include "diagnostics.hpp"

#include "rodwake/rods/couplings.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

/// A sentence like "the data do not fix eta and xi separately: raising eta by 1 % and lowering xi by 0.8 %
/// changes the residuals hardly or not at all".
std::string sentence(const Problem& problem, const Fit& fit, const FlatDirection& flat, bool exactly) {
    // Relative change of each value along the direction, or the change itself if the value is 0.
    struct Move {
        std::string name;
        double amount = 0.0;
        bool relative = true;
    };
    std::vector<Move> moves;
    double largest = 0.0;
    for (std::size_t i = 0; i < flat.change.size(); ++i) {
        const Parameter& p = problem.parameters[i];
        const double value = fit.values[i];
        const bool log = p.transform == Transform::log;
        if (!p.free() || flat.change[i] == 0.0)
            continue;
        moves.push_back({p.name, log || value == 0.0 ? flat.change[i] : flat.change[i] / std::abs(value),
                         log || value != 0.0});
        largest = std::max(largest, std::abs(moves.back().amount));
    }
    const char* fix = exactly ? "do not fix" : "hardly fix";
    if (moves.size() == 1)
        return fmt::format("the data {} {}: {}", fix, moves.front().name,
                           exactly ? "the residuals do not depend on it here"
                                   : "the residuals hardly depend on it");
    const double unit = (moves.front().amount < 0.0 ? -1.0 : 1.0) / largest;
    std::string listed, changes;
    for (std::size_t i = 0; i < moves.size(); ++i) {
        const double amount = std::abs(moves[i].amount) * std::abs(unit);
        listed += (i == 0 ? "" : i + 1 == moves.size() ? " and " : ", ") + moves[i].name;
        changes += fmt::format(
            "{}{} {} by {}", i == 0 ? "" : " and ", moves[i].amount * unit > 0.0 ? "raising" : "lowering",
            moves[i].name,
            moves[i].relative ? fmt::format("{:.2g} %", amount)
                              : fmt::format("{:.2g}", 0.01 * std::abs(moves[i].amount) * std::abs(unit)));
    }
    return fmt::format("the data {} {} separately: {} {}", fix, listed, changes,
                       exactly ? "changes the residuals hardly or not at all"
                               : "changes the residuals by less than a thousandth of what either does alone");
}

/// Of all parameters, those that take part by less than a thousandth left out, largest = 1.
std::vector<double> change_of(const Problem& problem, const Fit& fit, const SearchSpace& space,
                              const Eigen::VectorXd& direction, const Eigen::VectorXd& part) {
    std::vector<double> change(problem.parameters.size());
    double largest = 0.0;
    for (Eigen::Index k = 0; k < space.size(); ++k) {
        const std::size_t i = space.free[k];
        if (std::abs(part[k]) > 1e-3)
            change[i] = direction[k] * space.slope(k, space.logarithmic(k) ? 1.0 : fit.values[i]);
        largest = std::max(largest, std::abs(change[i]));
    }
    for (double& c : change)
        c = c == 0.0 ? 0.0 : c / largest;
    for (std::size_t i = 0; i < change.size(); ++i)
        if (const Parameter& p = problem.parameters[i]; !p.tied_to.empty()) {
            const auto to = std::ranges::find(problem.parameters, p.tied_to, &Parameter::name);
            const double by = to->transform == Transform::log ? 1.0 : p.tie_factor;
            change[i] = by * change[static_cast<std::size_t>(to - problem.parameters.begin())];
        }
    return change;
}

} // namespace

std::vector<FlatDirection> flat_directions(const Problem& problem, const Fit& fit, const SearchSpace& space,
                                           const Curvature& c) {
    std::vector<FlatDirection> all;
    for (Eigen::Index i = c.singular_values.size() - 1; i >= 0 && c.singular_values[i] < 1e-3; --i) {
        FlatDirection flat;
        flat.singular_value = c.singular_values[i];
        flat.change = change_of(problem, fit, space, c.directions.col(i), c.scaled.col(i));
        flat.text = sentence(problem, fit, flat, i >= c.rank);
        all.push_back(std::move(flat));
    }
    return all;
}

namespace {

using Diagnostics = std::vector<std::string>;
constexpr double poor_chi2 = 0.01; // probability

/// The scatter of the residuals: whether chi2 is as expected, and what errors were taken from it.
void add_scatter(Diagnostics& diagnostics, const Problem& problem, const Fit& fit, const Report& report) {
    if (problem.sigma_known && report.dof > 0 && std::isfinite(report.chi2)) {
        const double reduced = report.chi2 / static_cast<double>(report.dof);
        if (report.probability < poor_chi2)
            diagnostics.push_back(fmt::format(
                "poor chi2: {:.4g} for {} degrees of freedom (probability {}); the model is not exact or the "
                "errors of the data are underestimated; if it is the latter, errors of the parameters grow "
                "by a "
                "factor of {:.3g}",
                report.chi2, report.dof, describe_probability(report.probability), std::sqrt(reduced)));
        else if (report.probability > 0.999)
            diagnostics.push_back(
                fmt::format("chi2 {:.4g} is small for {} degrees of freedom: the errors of the "
                            "data are overestimated, or neighbouring data share noise",
                            report.chi2, report.dof));
    }
    if (fit.loss != Loss::squares && std::isfinite(report.error_factor))
        diagnostics.push_back(
            fmt::format("robust loss ({}, width {:g}): errors from the scatter of the residuals, {:.3g} "
                        "times those of plain least squares",
                        fit.loss == Loss::huber ? "huber" : "cauchy", fit.loss_width, report.error_factor));
    else if (!problem.sigma_known && std::isfinite(report.error_factor))
        diagnostics.push_back(fmt::format(
            "no sigmas were given: errors from the scatter of the residuals about the fit, {:.3g}",
            report.error_factor));
    if (report.dof <= 0 && std::isinf(report.error_factor) && std::isfinite(report.chi2))
        diagnostics.push_back(
            "errors unknown: as many parameters as data points leave no scatter to take them "
            "from; give sigmas, or more data");
}

/// Ends more than one standard error, or a hundredth, away in some parameter that has an error.
bool elsewhere(const Report& report, const Fit& fit, const StartResult& end) {
    for (std::size_t k = 0; k < report.free.size(); ++k) {
        const double error = report.estimates[report.free[k]].standard_error,
                     value = fit.values[report.free[k]];
        if (std::isfinite(error) && std::abs(end.end[k] - value) > std::max(error, 0.01 * std::abs(value)))
            return true;
    }
    return false;
}

std::string place(const Report& report, const StartResult& end) {
    std::string text;
    for (std::size_t k = 0; k < report.free.size(); ++k)
        text += fmt::format("{}{} = {:.4g}", k == 0 ? "" : ", ", report.estimates[report.free[k]].name,
                            end.end[k]);
    return text;
}

/// Ends that differ by rounding errors, of which the fit's is one.
bool as_low(const Fit& fit, const StartResult& end) {
    return std::abs(end.objective - fit.objective) <= 1e-9 * std::abs(fit.objective) + 1e-12;
}

/// Where the other starts ended.
void add_starts(Diagnostics& diagnostics, const Problem& problem, const Fit& fit, const Report& report,
                double rise) {
    std::vector<StartResult> equal, nearly;
    for (const StartResult& s : fit.starts) {
        if (!elsewhere(report, fit, s))
            continue;
        if (as_low(fit, s))
            equal.push_back(s);
        else if (s.objective - fit.objective < 4.0 * rise)
            nearly.push_back(s);
    }
    if (!equal.empty())
        diagnostics.push_back(fmt::format(
            "of the {} starts that ended at the best objective {} ended at other values, for one at {}: the "
            "data do not distinguish these",
            report.same_optimum, equal.size(), place(report, equal.front())));
    if (!nearly.empty()) {
        const StartResult& best = *std::ranges::min_element(nearly, {}, &StartResult::objective);
        diagnostics.push_back(fmt::format(
            "{} of {} starts ended elsewhere and nearly as well; the best of them at {} with an "
            "objective only {:.3g} above the best",
            nearly.size(), fit.starts.size(), place(report, best), best.objective - fit.objective));
    }
    const auto failed =
        std::ranges::count_if(fit.starts, [](const StartResult& s) { return !std::isfinite(s.objective); });
    if (failed > 0 && fit.termination != Termination::failed)
        diagnostics.push_back(
            fmt::format("{} of {} starts found no point with finite residuals", failed, fit.starts.size()));

    // If few starts reach the best optimum, perhaps none is at the best there is.
    if (!std::isfinite(fit.objective))
        return;
    const std::size_t n = fit.starts.size();
    if (n >= 5 && 2 * report.same_optimum < n)
        diagnostics.push_back(
            fmt::format("only {} of {} starts reached the best optimum: more starts may find a better one",
                        report.same_optimum, n));
    const bool poor = problem.sigma_known && report.dof > 0 && report.probability < poor_chi2;
    const bool bound = std::ranges::any_of(
        report.estimates, [](const ParameterEstimate& e) { return e.at_lower || e.at_upper; });
    if (n == 1 && (poor || bound))
        diagnostics.push_back("a single start may have ended in a minimum that is not the deepest: try "
                              "fit.starts = 20");
}

} // namespace

bool at_the_best(const Fit& fit, const Report& report, const StartResult& start) {
    const bool near = start.objective <= fit.objective * (1.0 + 1e-4) + 1e-8;
    return as_low(fit, start) || (near && !elsewhere(report, fit, start));
}

std::string describe_probability(double probability) {
    return probability < 1e-300 ? "< 1e-300" : fmt::format("{:.3g}", probability);
}

std::vector<std::string> diagnostics_of(const Problem& problem, const Fit& fit, const Report& report,
                                        double rise, bool exact) {
    Diagnostics diagnostics = problem.remarks;
    if (fit.termination == Termination::failed)
        diagnostics.push_back(fmt::format("the fit failed: {}", fit.reason));
    else if (fit.termination == Termination::interrupted)
        diagnostics.push_back("the fit was interrupted: these are the best values so far");
    else if (fit.termination == Termination::budget)
        diagnostics.push_back(fmt::format("not converged ({}): allow more evaluations", fit.reason));
    for (const FlatDirection& flat : report.flat)
        diagnostics.push_back(flat.text);

    // Along a flat direction the gradient is worth any number of its huge errors; that it is flat says more.
    const bool finished =
        fit.termination == Termination::converged || fit.termination == Termination::roundoff;
    if (finished && !exact && !(fit.distance <= 0.5)) // NaN too
        diagnostics.push_back(
            fmt::format("not at a stationary point: the gradient is worth {:.2g} standard errors; errors "
                        "are not to be trusted ({})",
                        fit.distance, fit.reason));
    else if (finished && !exact && fit.distance > 0.05 && report.flat.empty())
        diagnostics.push_back(
            fmt::format("not quite at a stationary point: by the gradient the values may be off "
                        "by {:.2g} standard errors; the errors themselves hold ({})",
                        fit.distance, fit.reason));
    for (std::size_t i = 0; i < report.estimates.size(); ++i) {
        const ParameterEstimate& e = report.estimates[i];
        const Parameter& p = problem.parameters[i];
        if (e.at_lower || e.at_upper) {
            const bool unlimited = e.at_lower ? e.high == p.upper : e.low == p.lower;
            const std::string allowed =
                unlimited
                    ? fmt::format("the data do not constrain it: any value {} fits within 95 %",
                                  std::isfinite(p.upper - p.lower) ? "between its bounds"
                                                                   : "beyond the bound")
                    : fmt::format("the data allow {} {:.4g} (95 %, one-sided, by the profile likelihood)",
                                  e.at_lower ? "values up to" : "values down to",
                                  e.at_lower ? e.high : e.low);
            diagnostics.push_back(
                fmt::format("{} is on its {} bound {:.6g}: it has no error, and the errors of the others "
                            "hold for it fixed there; {}",
                            e.name, e.at_lower ? "lower" : "upper", e.at_lower ? p.lower : p.upper, allowed));
        } else if (e.free && e.standard_error > 0.0 && e.low < p.lower && e.high > p.upper)
            diagnostics.push_back(fmt::format(
                "the data do not constrain {}: its 95 % interval reaches beyond both of its bounds", e.name));
    }
    // Couplings turn a rod by some radians while it goes f/mu; far above that the data are in other units.
    constexpr double largest = 1e5;
    for (const ParameterEstimate& e : report.estimates)
        if (rods::find_coupling(e.name) && std::abs(e.value) > largest)
            diagnostics.push_back(fmt::format(
                "{} = {:.3g} is no coupling of rods (usual are 0.01 to 1000): are f_over_mu and speed of "
                "the tracks right, and their headings in radians?",
                e.name, e.value));
    add_scatter(diagnostics, problem, fit, report);
    add_starts(diagnostics, problem, fit, report, rise);
    return diagnostics;
}

std::vector<bool> held_by_bounds(const SearchSpace& space, const Eigen::VectorXd& u,
                                 const Eigen::VectorXd& gradient) {
    std::vector<bool> held(static_cast<std::size_t>(u.size()));
    for (Eigen::Index k = 0; k < u.size(); ++k)
        held[k] =
            (u[k] <= space.lower[k] && gradient[k] >= 0.0) || (u[k] >= space.upper[k] && gradient[k] <= 0.0);
    return held;
}

Stationarity stationarity(const Evaluator& evaluator, const SearchPoint& point) {
    Weighted w = evaluator.weighted(point);
    const Eigen::VectorXd g = w.a.transpose() * w.b;
    const std::vector<bool> held = held_by_bounds(evaluator.space(), point.u, g);
    Eigen::VectorXd norms = w.a.colwise().norm().transpose();
    for (Eigen::Index k = 0; k < g.size(); ++k) {
        norms[k] = held[k] || norms[k] == 0.0 ? 0.0 : 1.0 / norms[k];
        w.a.col(k) *= norms[k];
    }
    if (norms.size() == 0 || norms.maxCoeff() == 0.0)
        return {};
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Eigen::MatrixXd(w.a),
                                                Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd& s = svd.singularValues();
    Eigen::VectorXd variance = Eigen::VectorXd::Zero(g.size()), step = variance;
    for (Eigen::Index i = 0; i < s.size() && s[i] > 1e-10 * s[0]; ++i) {
        variance += (svd.matrixV().col(i) / s[i]).cwiseAbs2();
        step += svd.matrixV().col(i) * (svd.matrixU().col(i).dot(w.b) / s[i]);
    }
    step.array() *= norms.array() / point.u.array().abs().max(1e-300);
    return {(g.array() * norms.array() * variance.array().sqrt()).matrix().norm(),
            step.cwiseAbs().maxCoeff()};
}

Curvature curvature(const SearchSpace& space, const SearchPoint& point, const Eigen::VectorXd& gradient,
                    double rank_tolerance) {
    Curvature c;
    c.held.resize(static_cast<std::size_t>(point.u.size()));
    for (Eigen::Index k = 0; k < point.u.size(); ++k) {
        const double near = 1e-9 * std::max(1.0, std::abs(point.u[k]));
        const double above = point.u[k] - space.lower[k], below = space.upper[k] - point.u[k];
        c.held[k] = above <= 0.0 || below <= 0.0 || (above <= near && gradient[k] > 0.0) ||
                    (below <= near && gradient[k] < 0.0);
    }
    const Eigen::VectorXd norms = point.jacobian.colwise().stableNorm().transpose();
    std::vector<Eigen::Index> used;
    for (Eigen::Index k = 0; k < norms.size(); ++k)
        if (!c.held[k])
            used.push_back(k);
    const auto n = static_cast<Eigen::Index>(used.size());
    c.scaled = c.directions = Eigen::MatrixXd::Zero(norms.size(), n);
    c.singular_values = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd per_length = norms.unaryExpr([](double l) { return l > 0.0 ? 1.0 / l : 1.0; });
    double largest = 0.0;
    if (n > 0) {
        const Eigen::MatrixXd j = (point.jacobian * per_length.asDiagonal())(Eigen::all, used);
        const Eigen::MatrixXd r = j.householderQr().matrixQR().topRows(n).triangularView<Eigen::Upper>();
        const Eigen::JacobiSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeFullV);
        c.scaled(used, Eigen::all) = svd.matrixV();
        c.directions = per_length.asDiagonal() * c.scaled;
        largest = svd.singularValues()[0];
        if (largest > 0.0)
            c.singular_values = svd.singularValues() / largest;
        c.rank = (c.singular_values.array() > rank_tolerance).count();
    }

    // The errors of parameters that take part in a flat direction are infinite.
    constexpr double takes_part =
        1e-6; // component of a unit vector; far above the rounding errors of the SVD
    c.root = Eigen::MatrixXd::Zero(norms.size(), c.rank);
    for (Eigen::Index i = 0; i < c.rank; ++i)
        c.root.col(i) = c.directions.col(i) / (c.singular_values[i] * largest);
    c.standard_error = c.root.rowwise().stableNorm();
    for (Eigen::Index i = c.rank; i < n; ++i)
        for (Eigen::Index k = 0; k < norms.size(); ++k)
            if (std::abs(c.scaled(k, i)) > takes_part)
                c.standard_error[k] = infinite;
    return c;
}

// Huber, Robust Statistics, section 7.6: C (n/(n - p)) mean(psi^2)/mean(psi')^2, psi = rho' r.
ErrorScale error_scale(const Problem& problem, const LossShape& loss, const SearchPoint& point, long dof) {
    const bool robust = loss.loss != Loss::squares;
    if (problem.sigma_known && !robust)
        return {};
    if (dof <= 0)
        return {infinite, infinite};
    double psi2 = 0.0, curvature = 0.0;
    for (const double r : point.r) {
        const LossValue value = loss_of(loss, r * r);
        psi2 += value.first * value.first * r * r;
        curvature += value.curvature(r * r);
    }
    const double bend = std::max(curvature / static_cast<double>(point.r.size()), 1e-3);
    const double variance = psi2 / static_cast<double>(dof) / (bend * bend);
    return {std::sqrt(variance), variance * bend};
}

} // namespace rodwake::fitting
