#include "words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

using Remarks = std::vector<std::string>;

void add_ending(Remarks& remarks, const Fit& fit, bool exact) {
    if (fit.termination == Termination::failed)
        remarks.push_back(fmt::format("the fit failed: {}", fit.reason));
    else if (fit.termination == Termination::interrupted)
        remarks.push_back("the fit was interrupted: these are the best values so far");
    else if (fit.termination == Termination::budget)
        remarks.push_back(fmt::format("not converged ({}): allow more evaluations", fit.reason));
    else if (!exact && !(fit.distance <= 1e-3))
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
    if (fit.loss != Loss::squares)
        remarks.push_back(
            fmt::format("robust loss ({}, width {:g}): errors from the scatter of the residuals, {:.3g} "
                        "times those of plain least squares",
                        fit.loss == Loss::huber ? "huber" : "cauchy", fit.loss_width, report.error_factor));
    else if (!problem.sigma_known && report.dof > 0)
        remarks.push_back(fmt::format(
            "no sigmas were given: errors from the scatter of the residuals about the fit, {:.3g}",
            report.error_factor));
    if (report.dof <= 0 && std::isinf(report.error_factor))
        remarks.push_back(
            "as many parameters as data points: the scatter and with it the errors are unknown");
}

void add_chi2(Remarks& remarks, const Problem& problem, const Report& report) {
    if (!problem.sigma_known || report.dof <= 0 || !std::isfinite(report.chi2))
        return;
    const double reduced = report.chi2 / static_cast<double>(report.dof);
    if (report.probability < 0.01)
        remarks.push_back(
            fmt::format("poor chi2: {:.4g} for {} degrees of freedom (probability {:.2g}); the model is "
                        "not exact or the sigmas are too small; if it is the sigmas, errors grow by {:.3g}",
                        report.chi2, report.dof, report.probability, std::sqrt(reduced)));
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

} // namespace

std::vector<std::string> remarks_of(const Problem& problem, const Fit& fit, const Report& report, double rise,
                                    bool exact) {
    Remarks remarks;
    add_ending(remarks, fit, exact);
    for (const FlatDirection& flat : report.flat)
        remarks.push_back(flat.text);
    add_bounds(remarks, problem, report);
    add_chi2(remarks, problem, report);
    add_errors(remarks, problem, fit, report);
    add_others(remarks, fit, report, rise);
    add_failed(remarks, fit);
    return remarks;
}

} // namespace rodwake::fitting
