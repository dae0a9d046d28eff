#include "fit_medium.hpp"

#include "rodwake/core/error.hpp"

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

FittedMedium medium_of(const fitting::Report& report) {
    const double f = *fitted_value(report, "f_over_mu"), eta = *fitted_value(report, "eta");
    FittedMedium m;
    m.strength = derived(report, f, {{"f_over_mu", 1.0}});
    m.eta = derived(report, eta, {{"eta", 1.0}});
    if (const auto alpha = fitted_value(report, "alpha")) {
        m.alpha = derived(report, *alpha, {{"alpha", 1.0}});
        m.xi = derived(report, 1.0 / *alpha, {{"alpha", -1.0 / (*alpha * *alpha)}});
    } else {
        const double xi = *fitted_value(report, "xi");
        m.alpha = derived(report, f / xi, {{"f_over_mu", 1.0 / xi}, {"xi", -f / (xi * xi)}});
        m.xi = derived(report, xi / f, {{"f_over_mu", -xi / (f * f)}, {"xi", 1.0 / f}});
    }
    return m;
}

void require_known(const FittedMedium& m, const fitting::Report& report) {
    const auto refuse = [](const std::string& what) {
        throw RunError(
            "medium.fitted: " + what +
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
}

nlohmann::ordered_json error_json(const Estimate& d) {
    return std::isfinite(d.error) ? nlohmann::ordered_json(d.error) : nlohmann::ordered_json(nullptr);
}

std::string medium_json(const FittedMedium& m, const std::string& length_unit) {
    const nlohmann::ordered_json json = {{"eta", m.eta.value},
                                         {"eta_stderr", error_json(m.eta)},
                                         {"xi", m.xi.value},
                                         {"xi_stderr", error_json(m.xi)},
                                         {"alpha", m.alpha.value},
                                         {"alpha_stderr", error_json(m.alpha)},
                                         {"f_over_mu_" + length_unit, m.strength.value},
                                         {"f_over_mu_" + length_unit + "_stderr", error_json(m.strength)},
                                         {"units", {{"eta", "1"}, {"xi", "f/mu"}, {"alpha", "1"}}}};
    return json.dump(2) + "\n";
}

std::string with_error(const char* name, const Estimate& d) {
    const std::string value = fmt::format("{} = {:.4g}", name, d.value);
    return d.known() ? value + fmt::format(" +- {:.2g}", d.error) : value;
}

/// What the medium is not to be trusted for.
void warn(const fitting::Report& report, const FitPlan& plan, const Logger& log) {
    for (const char* name : {"f_over_mu", "eta", "xi", "alpha"}) {
        const auto e = std::ranges::find(report.estimates, name, &fitting::Estimate::name);
        if (e != report.estimates.end() && at_bound(report, *e))
            log->warn("fitted medium: {} = {:.4g} is where a bound of fit.bounds holds it, not where the "
                      "data want it; "
                      "what follows from it has no error",
                      name, e->value);
    }
    if (plan.problem.sigma_known && report.dof > 0 && report.probability < 0.01)
        log->warn("fitted medium: the fit is poor, chi2 = {:.4g} for {} degrees of freedom: the medium may "
                  "be wrong by "
                  "more than its errors",
                  report.chi2, report.dof);
}

} // namespace

void take_fitted_medium(Session& session, const FitResults& results, const FitPlan& plan) {
    const FittedMedium m = medium_of(results.report);
    require_known(m, results.report);
    session.directory.write("medium.json", medium_json(m, plan.keys.length_unit));
    session.log->info("fitted medium: {}, {} f/mu, {}", with_error("eta", m.eta), with_error("xi", m.xi),
                      with_error("alpha", m.alpha));
    warn(results.report, plan, session.log);
    session.use_medium(m.eta.value, m.xi.value);
}

std::pair<double, double> stored_medium(const std::filesystem::path& file) try {
    std::ifstream in(file);
    const auto json = nlohmann::json::parse(in);
    return {json.at("eta").get<double>(), json.at("xi").get<double>()};
} catch (const nlohmann::json::exception&) {
    throw InputError(file.string() + ": the medium of the earlier fit cannot be read; --force fits again");
}

} // namespace rodwake::app
