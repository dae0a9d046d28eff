#include "words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

using Remarks = std::vector<std::string>;
constexpr double poor_chi2 = 0.01; // probability

void add_ending(Remarks& remarks, const Fit& fit) {
    if (fit.termination == Termination::failed)
        remarks.push_back(fmt::format("the fit failed: {}", fit.reason));
    else if (fit.termination == Termination::interrupted)
        remarks.push_back("the fit was interrupted: these are the best values so far");
    else if (fit.termination == Termination::budget)
        remarks.push_back(fmt::format("not converged ({}): allow more evaluations", fit.reason));
}

/// Along a flat direction the gradient is worth any number of its huge errors; that it is flat says more.
void add_distance(Remarks& remarks, const Fit& fit, const Report& report, bool exact) {
    const bool finished =
        fit.termination == Termination::converged || fit.termination == Termination::roundoff;
    if (!finished || exact || fit.distance <= 0.05 || (!report.flat.empty() && fit.distance <= 0.5))
        return;
    if (fit.distance <= 0.5)
        remarks.push_back(
            fmt::format("not quite at a stationary point: by the gradient the values may be off "
                        "by {:.2g} standard errors; the errors themselves hold ({})",
                        fit.distance, fit.reason));
    else
        remarks.push_back(
            fmt::format("not at a stationary point: the gradient is worth {:.2g} standard errors; errors "
                        "are not to be trusted ({})",
                        fit.distance, fit.reason));
}

void add_bounds(Remarks& remarks, const Problem& problem, const Report& report) {
    for (std::size_t i = 0; i < report.estimates.size(); ++i) {
        const Estimate& e = report.estimates[i];
        if (e.at_lower || e.at_upper)
            remarks.push_back(
                fmt::format("{} is on its {} bound {:.6g}: it has no error, and the errors of the others "
                            "hold for it fixed there",
                            e.name, e.at_lower ? "lower" : "upper",
                            e.at_lower ? problem.parameters[i].lower : problem.parameters[i].upper));
    }
}

void add_errors(Remarks& remarks, const Problem& problem, const Fit& fit, const Report& report) {
    if (fit.loss != Loss::squares && std::isfinite(report.error_factor))
        remarks.push_back(
            fmt::format("robust loss ({}, width {:g}): errors from the scatter of the residuals, {:.3g} "
                        "times those of plain least squares",
                        fit.loss == Loss::huber ? "huber" : "cauchy", fit.loss_width, report.error_factor));
    else if (!problem.sigma_known && std::isfinite(report.error_factor))
        remarks.push_back(fmt::format(
            "no sigmas were given: errors from the scatter of the residuals about the fit, {:.3g}",
            report.error_factor));
    if (report.dof <= 0 && std::isinf(report.error_factor) && std::isfinite(report.chi2))
        remarks.push_back("errors unknown: as many parameters as data points leave no scatter to take them "
                          "from; give sigmas, or more data");
}

void add_chi2(Remarks& remarks, const Problem& problem, const Report& report) {
    if (!problem.sigma_known || report.dof <= 0 || !std::isfinite(report.chi2))
        return;
    const double reduced = report.chi2 / static_cast<double>(report.dof);
    if (report.probability < poor_chi2)
        remarks.push_back(
            fmt::format("poor chi2: {:.4g} for {} degrees of freedom (probability {}); the model is "
                        "not exact or the sigmas are too small; if it is the sigmas, errors grow by {:.3g}",
                        report.chi2, report.dof, probability_words(report.probability), std::sqrt(reduced)));
    else if (report.probability > 0.999)
        remarks.push_back(
            fmt::format("chi2 {:.4g} is small for {} degrees of freedom: the sigmas are too large, or "
                        "neighbouring data share their noise",
                        report.chi2, report.dof));
}

/// Ends more than one standard error, or a hundredth, away in some parameter that has an error.
bool elsewhere(const Report& report, const Fit& fit, const StartEnd& end) {
    for (std::size_t k = 0; k < report.free.size(); ++k) {
        const double error = report.estimates[report.free[k]].stderr_, value = fit.values[report.free[k]];
        if (std::isfinite(error) && std::abs(end.end[k] - value) > std::max(error, 0.01 * std::abs(value)))
            return true;
    }
    return false;
}

std::string place(const Report& report, const StartEnd& end) {
    std::string text;
    for (std::size_t k = 0; k < report.free.size(); ++k)
        text += fmt::format("{}{} = {:.4g}", k == 0 ? "" : ", ", report.estimates[report.free[k]].name,
                            end.end[k]);
    return text;
}

void add_others(Remarks& remarks, const Fit& fit, const Report& report, double rise) {
    std::vector<StartEnd> others;
    for (const StartEnd& s : fit.starts)
        if (s.objective - fit.objective < 4.0 * rise && elsewhere(report, fit, s))
            others.push_back(s);
    if (others.empty())
        return;
    const StartEnd& best = *std::ranges::min_element(others, {}, &StartEnd::objective);
    remarks.push_back(
        fmt::format("{} of {} starts ended elsewhere and nearly as well; the best of them at {} with an "
                    "objective only {:.3g} above the best",
                    others.size(), fit.starts.size(), place(report, best), best.objective - fit.objective));
}

void add_failed(Remarks& remarks, const Fit& fit) {
    const auto failed =
        std::ranges::count_if(fit.starts, [](const StartEnd& s) { return !std::isfinite(s.objective); });
    if (failed > 0 && fit.termination != Termination::failed)
        remarks.push_back(
            fmt::format("{} of {} starts found no place with finite residuals", failed, fit.starts.size()));
}

/// Few starts at the best optimum: perhaps none is at the best there is.
void add_starts(Remarks& remarks, const Problem& problem, const Fit& fit, const Report& report) {
    if (!std::isfinite(fit.objective))
        return;
    const std::size_t n = fit.starts.size();
    if (n >= 5 && 2 * report.same_optimum < n)
        remarks.push_back(
            fmt::format("only {} of {} starts reached the best optimum: more starts may find a better one",
                        report.same_optimum, n));
    const bool poor = problem.sigma_known && report.dof > 0 && report.probability < poor_chi2;
    const bool bound =
        std::ranges::any_of(report.estimates, [](const Estimate& e) { return e.at_lower || e.at_upper; });
    if (n == 1 && (poor || bound))
        remarks.push_back("a single start may have ended in a minimum that is not the deepest: try "
                          "fit.starts = 20");
}

} // namespace

std::string probability_words(double probability) {
    return probability < 1e-300 ? "< 1e-300" : fmt::format("{:.3g}", probability);
}

std::vector<std::string> remarks_of(const Problem& problem, const Fit& fit, const Report& report, double rise,
                                    bool exact) {
    Remarks remarks;
    add_ending(remarks, fit);
    for (const FlatDirection& flat : report.flat)
        remarks.push_back(flat.text);
    add_distance(remarks, fit, report, exact);
    add_bounds(remarks, problem, report);
    add_chi2(remarks, problem, report);
    add_errors(remarks, problem, fit, report);
    add_others(remarks, fit, report, rise);
    add_failed(remarks, fit);
    add_starts(remarks, problem, fit, report);
    return remarks;
}

} // namespace rodwake::fitting
