#include "fit_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

std::string counted(std::size_t count, const char* noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// "eta = 2.18 +- 0.13" of each parameter and derived quantity, with the total error: curvature, held
/// constants, masks and runs.
std::vector<std::string> value_lines(const FitPlan& plan, const FitResults& results) {
    const fitting::Report& report = results.report;
    const bool errors_known = std::isfinite(report.error_factor);
    const auto unit_of = [&](const std::string& name) {
        const std::string unit = fit_unit(plan.keys, name);
        return unit.empty() || unit == "1" ? "" : " " + unit;
    };
    const auto with_error = [&](const std::string& name) {
        return fmt::format(" +- {:.2g}", whole_error(results, name));
    };
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < report.estimates.size(); ++i) {
        const fitting::ParameterEstimate& e = report.estimates[i];
        const std::string value = fmt::format("{} = {:.6g}", e.name, e.value), unit = unit_of(e.name);
        if (plan.problem.parameters[i].fixed)
            lines.push_back(value + unit + " (fixed)");
        else if (e.at_lower || e.at_upper)
            lines.push_back(value + unit +
                            fmt::format(" (at its {} bound), 95 % interval {:.5g} to {:.5g}",
                                        e.at_lower ? "lower" : "upper", e.low, e.high));
        else if (std::isfinite(e.standard_error))
            lines.push_back(fmt::format("{}{}{}", value, with_error(e.name), unit));
        else
            lines.push_back(value + unit + (errors_known ? ", not fixed by the data" : ", error unknown"));
    }
    for (const auto& [name, d] : results.derived)
        lines.push_back(fmt::format("{} = {:.6g}{}{}", name, d.value,
                                    d.not_fixed()  ? ", not fixed by the data"
                                    : d.known()    ? with_error(name)
                                    : errors_known ? ""
                                                   : ", error unknown",
                                    unit_of(name)));
    return lines;
}

/// Warns of tracks whose rods turn so far between rows that the linear filter fails: the path error of
/// standard deviation D_r t^2/sqrt(3) is then no longer small beside sigma_position.
void log_turning(const FitPlan& plan, const FitResults& results, const Logger& log) {
    constexpr double limit = 0.2; // up to there ranks are uniform: studies/reports/fitting.md
    const auto e = std::ranges::find(results.report.estimates, "D_r", &fitting::ParameterEstimate::name);
    if (e == results.report.estimates.end())
        return;
    for (const FitTrackData& track : plan.tracks) {
        double longest = 0.0;
        for (std::size_t i = 1; i < track.data.times.size(); ++i)
            longest = std::max(longest, track.data.times[i] - track.data.times[i - 1]);
        const double error = e->value * longest * longest / std::sqrt(3.0) / track.data.sigma_position;
        if (error > limit)
            log->info("fit: {}: the rods turn too much between rows for the Kalman filter at D_r = {:.3g} "
                      "(path error {:.2g} sigma_position; limit {}). Errors, above all of D_r, are "
                      "underestimated: use more closely spaced rows or a larger sigma_position",
                      track.name, e->value, error, limit);
    }
}

void log_likelihood(const std::string& name, const fitting::ProfileLikelihood& likelihood, double best,
                    const Logger& log) {
    const auto &low = likelihood.low, &high = likelihood.high;
    log->info("fit: {}: 95 % interval by the profile likelihood {}", name,
              low && high ? fmt::format("{:.5g} to {:.5g}", *low, *high)
              : high      ? fmt::format("up to {:.5g}, without a lower end within the bounds", *high)
              : low       ? fmt::format("{:.5g} and above, without an upper end within the bounds", *low)
                          : "none: the data do not constrain it within the bounds");
    const auto lowest = std::ranges::min_element(likelihood.chi2);
    if (*lowest < best - 1e-3 * (1.0 + 1e-3 * best))
        log->info(
            "fit: the profile likelihood of {} found an objective {:.3g} lower than the fit, at {} = {:.5g}: "
            "start there (fit.start), or increase fit.starts",
            name, best - *lowest, name,
            likelihood.value[static_cast<std::size_t>(lowest - likelihood.chi2.begin())]);
}

} // namespace

void log_fit_data(const FitPlan& plan, const Logger& log) {
    // One line names all data; their files are only in log.txt.
    std::vector<std::string> fitted, predicted;
    if (!plan.maps.empty()) {
        std::size_t all_used = 0, bins = 0;
        for (const FitMapData& m : plan.maps) {
            const std::size_t used = fitting::used_bins(m.data, plan.mask).size();
            all_used += used;
            bins += m.data.bins();
            log->debug("fit: map {}: {} of {} bins are fitted, {}", m.name, used, m.data.bins(),
                       m.file.string());
        }
        fitted.push_back(fmt::format("{} ({} of {} bins)", counted(plan.maps.size(), "map"), all_used, bins));
    }
    for (std::size_t i = 0; i < plan.profiles.size(); ++i) {
        const FitProfileData& p = plan.profiles[i];
        const bool fit = plan.keys.profiles[i].role == scene::FitRole::fit;
        (fit ? fitted : predicted)
            .push_back(fmt::format("profile {} ({})", p.name, counted(p.data.place.size(), "point")));
        log->debug("fit: profile {} from {}", p.name, p.file.string());
    }
    for (const FitTrackData& t : plan.tracks) {
        fitted.push_back(fmt::format("trajectory {} ({}, {})", t.name, counted(t.rods, "rod"),
                                     counted(t.data.times.size(), "row")));
        log->debug("fit: trajectory {} from {}", t.name, t.file.string());
    }
    log->info("fit: data: {}{}{}", fmt::join(fitted, ", "),
              predicted.empty() ? "" : "; to predict: ", fmt::join(predicted, ", "));

    // Data that were left out or changed, and remarks, which are logged here too since the fit may fail.
    for (const FitProfileData& p : plan.profiles)
        if (p.left_out > 0)
            log->warn("fit: {}: {} points without a sigma are left out", p.file.string(), p.left_out);
    for (const FitMapData& m : plan.maps) {
        if (m.left_out > 0)
            log->warn("fit: {}: {} bins without a sigma are left out", m.file.string(), m.left_out);
        if (m.mirrored)
            log->info("fit: {}: both sides hold the same numbers; y > 0 is fitted", m.file.string());
    }
    for (const FitTrackData& t : plan.tracks) {
        if (t.left_out > 0)
            log->info("fit: {}: {} rows with an unknown rod are left out", t.file.string(), t.left_out);
        if (t.unwrapped)
            log->info("fit: {}: headings that jump by half a turn were unwrapped", t.file.string());
    }
    for (const std::string& remark : plan.problem.remarks)
        log->warn("fit: {}", remark);
}

void log_fit_results(const FitPlan& plan, const FitResults& results, const Logger& log) {
    // A line for each parameter; fits with errors by cause have many, which share a line.
    const fitting::Report& r = results.report;
    const std::vector<std::string> values = value_lines(plan, results);
    if (!results.systematics.total.empty())
        log->info("fit: {} (errors with those of held constants, masks and runs)", fmt::join(values, ", "));
    else
        for (const std::string& line : values)
            log->info("fit: {}", line);

    // How good the fit is.
    const fitting::Misfit& misfit = results.misfit;
    log->info("fit: chi2 = {:.4g} for {} degrees of freedom{}; {} of {} starts ended there", r.chi2, r.dof,
              misfit.describes()
                  ? ""
                  : fmt::format("; the model does not describe the data: {} (p {})", misfit.worst,
                                *misfit.probability < 0.001 ? "< 0.001"
                                                            : fmt::format("= {:.2g}", *misfit.probability)),
              r.same_optimum, results.fit.starts.size());
    log->debug("fit: {} ({})", to_string(results.fit.termination), results.fit.reason);
    log_turning(plan, results, log);
    for (const auto& [name, likelihood] : results.likelihood)
        log_likelihood(name, likelihood, results.fit.objective, log);

    // Predicted profiles, by the factor between data and prediction.
    std::vector<std::string> predicted;
    for (std::size_t i = 0; i < results.profiles.size(); ++i)
        if (const auto& factor = results.profiles[i].scale_factor;
            factor && plan.keys.profiles[i].role == scene::FitRole::predict)
            predicted.push_back(fmt::format(
                "{}: predicted; data over prediction {:.4g}{}, chi2 = {:.4g} for {} points",
                plan.profiles[i].name, factor->scale,
                std::isfinite(factor->standard_error) ? fmt::format(" +- {:.2g}", factor->standard_error)
                                                      : ", error unknown",
                factor->chi2, factor->points));
    if (!predicted.empty())
        log->info("fit: {}", fmt::join(predicted, "; "));

    // Point forces that were fitted to one line alone.
    for (std::size_t k = 0; k < results.compare.size(); ++k)
        if (const auto& line = results.compare[k].line) {
            std::vector<std::string> estimates;
            for (const fitting::ParameterEstimate& e : line->estimates)
                estimates.push_back(fmt::format("{} = {:.4g}{}", e.name, e.value,
                                                e.at_lower || e.at_upper
                                                    ? " (at its bound)"
                                                    : fmt::format(" +- {:.2g}", e.standard_error)));
            const auto profile = static_cast<std::size_t>(*plan.keys.compare[k].line);
            log->debug(
                "fit: {}: a point force fitted to {} alone gives {}, chi2 = {:.4g} for {} degrees of freedom",
                plan.keys.compare[k].name, plan.profiles[profile].name, fmt::join(estimates, ", "),
                line->chi2, line->dof);
        }
    if (!r.diagnostics.empty())
        log->warn("fit: {}", fmt::join(r.diagnostics, "; "));
}

void log_posterior(const FitPlan& plan, const fitting::Posterior& posterior, const Logger& log) {
    for (std::size_t k = 0; k < posterior.free.size(); ++k) {
        const fitting::Marginal& m = posterior.marginals[k];
        log->info("posterior: {} = {:.6g} +- {:.2g}, 95 % within {:.5g} and {:.5g}; R-hat {:.4f}, {:.0f} "
                  "effective samples",
                  plan.problem.parameters[posterior.free[k]].name, m.mean, m.sd, m.q025, m.q975, m.rhat,
                  m.ess);
    }
    if (posterior.log_evidence)
        log->info("posterior: log evidence {:.3f} +- {:.2g}", posterior.log_evidence->value,
                  posterior.log_evidence->error);
    for (const std::string& remark : posterior.remarks)
        log->warn("posterior: {}", remark);
}

} // namespace rodwake::app
