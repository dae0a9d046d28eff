#include "fit_stage.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "run/record_json.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace rodwake::app {

namespace {

struct FittedMedium {
    Estimate eta, xi, alpha, strength; ///< xi in f/mu
};

FittedMedium medium_of(const FitResults& results) {
    const fitting::Report& report = results.report;
    const double f = *fitted_value(report, "f_over_mu"), eta = *fitted_value(report, "eta");
    FittedMedium m;
    m.strength = derived(report, f, {{"f_over_mu", 1.0}});
    m.eta = derived(report, eta, {{"eta", 1.0}});
    if (const auto area = fitted_value(report, "drag_area")) {
        const Estimate alpha = results.derived.at("alpha");
        m.alpha = {alpha.value, whole_error(results, "alpha"), alpha.count};
        m.xi = {1.0 / alpha.value, m.alpha.error / (alpha.value * alpha.value), alpha.count};
        m.strength.error = whole_error(results, "f_over_mu");
        m.eta.error = whole_error(results, "eta");
    } else if (const auto alpha = fitted_value(report, "alpha")) {
        m.alpha = derived(report, *alpha, {{"alpha", 1.0}});
        m.xi = derived(report, 1.0 / *alpha, {{"alpha", -1.0 / (*alpha * *alpha)}});
    } else {
        const double xi = *fitted_value(report, "xi");
        m.alpha = derived(report, f / xi, {{"f_over_mu", 1.0 / xi}, {"xi", -f / (xi * xi)}});
        m.xi = derived(report, xi / f, {{"f_over_mu", -xi / (f * f)}, {"xi", 1.0 / f}});
    }
    return m;
}

} // namespace

void take_fitted_medium(Session& session, const FitResults& results, const FitPlan& plan) {
    const fitting::Report& report = results.report;
    const FittedMedium m = medium_of(results);

    // Later stages need a medium whose constants the data constrain.
    const auto refuse = [](const std::string& why) {
        throw RunError(
            "medium.fitted: " + why +
            "; give eta and xi in [medium] instead of fitted = true, or fix one of them in fit.fixed");
    };
    if (!std::isfinite(report.error_factor))
        refuse("the errors of the fit are unknown");
    if (m.eta.not_fixed() || m.xi.not_fixed())
        refuse(fmt::format("the data do not fix {}", !m.eta.not_fixed()  ? "xi"
                                                     : !m.xi.not_fixed() ? "eta"
                                                                         : "eta and xi"));
    if (!(m.xi.value > 0.0) || !std::isfinite(m.xi.value))
        refuse(
            fmt::format("the fit gives f_over_mu = {:.4g} and with it xi = {:.4g} f/mu, which is no medium",
                        m.strength.value, m.xi.value));

    const std::string strength = "f_over_mu_" + plan.keys.length_unit;
    const nlohmann::ordered_json json = {{"eta", m.eta.value},
                                         {"eta_stderr", finite_or_null(m.eta.error)},
                                         {"xi", m.xi.value},
                                         {"xi_stderr", finite_or_null(m.xi.error)},
                                         {"alpha", m.alpha.value},
                                         {"alpha_stderr", finite_or_null(m.alpha.error)},
                                         {strength, m.strength.value},
                                         {strength + "_stderr", finite_or_null(m.strength.error)},
                                         {"units", {{"eta", "1"}, {"xi", "f/mu"}, {"alpha", "1"}}}};
    session.directory.write("medium.json", json_text(json, 2) + "\n");

    // The log has the constants, and warns of bounds and of a poor fit.
    const auto with_error = [](const char* name, const Estimate& d) {
        return fmt::format("{} = {:.4g}", name, d.value) +
               (d.known() ? fmt::format(" +- {:.2g}", d.error) : "");
    };
    session.log->debug("fitted medium: {}, {} f/mu, {}", with_error("eta", m.eta), with_error("xi", m.xi),
                       with_error("alpha", m.alpha));
    for (const char* name : {"f_over_mu", "eta", "xi", "alpha"}) {
        const auto e = std::ranges::find(report.estimates, name, &fitting::ParameterEstimate::name);
        if (e != report.estimates.end() && at_bound(report, *e))
            session.log->warn(
                "fitted medium: {0} = {1:.4g} lies at a bound of fit.bounds, so the data do not determine "
                "it, and "
                "quantities derived from it have no error: widen fit.bounds.{0}, or fix {0} in fit.fixed",
                name, e->value);
    }
    if (plan.problem.sigma_known && report.dof > 0 && report.probability < 0.01)
        session.log->warn(
            "fitted medium: the fit is poor, chi2 = {:.4g} for {} degrees of freedom: the medium may "
            "be wrong by more than its errors",
            report.chi2, report.dof);
    session.use_medium(m.eta.value, m.xi.value);
}

void take_stored_medium(Session& session) {
    if (!session.plan.scene.medium || !session.plan.scene.medium->fitted)
        return;
    const auto file = session.directory.file("medium.json");
    std::ifstream in(file);
    try {
        const auto json = nlohmann::json::parse(in);
        session.use_medium(json.at("eta").get<double>(), json.at("xi").get<double>());
    } catch (const nlohmann::json::exception&) {
        throw InputError(file.string() +
                         ": the medium of the earlier fit cannot be read; --force fits again");
    }
}

} // namespace rodwake::app
