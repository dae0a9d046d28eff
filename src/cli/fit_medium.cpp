#include "fit_medium.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace rodwake::cli {

namespace {

struct FittedMedium {
    FitDerived eta, xi, alpha, strength; ///< xi in f/mu
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

void require_known(const FittedMedium& m) {
    const auto refuse = [](const std::string& what) {
        throw RunError(
            "medium.fitted: " + what +
            "; give eta and xi in [medium] instead of fitted = true, or fix one of them in fit.fixed");
    };
    if (!std::isfinite(m.eta.error) || !std::isfinite(m.xi.error))
        refuse(fmt::format("the data do not fix {}", std::isfinite(m.eta.error)  ? "xi"
                                                     : std::isfinite(m.xi.error) ? "eta"
                                                                                 : "eta and xi"));
    if (!(m.xi.value > 0.0) || !std::isfinite(m.xi.value))
        refuse(
            fmt::format("the fit gives f_over_mu = {:.4g} and with it xi = {:.4g} f/mu, which is no medium",
                        m.strength.value, m.xi.value));
}

std::string medium_json(const FittedMedium& m, const std::string& length_unit) {
    const nlohmann::ordered_json json = {{"eta", m.eta.value},
                                         {"eta_stderr", m.eta.error},
                                         {"xi", m.xi.value},
                                         {"xi_stderr", m.xi.error},
                                         {"alpha", m.alpha.value},
                                         {"alpha_stderr", m.alpha.error},
                                         {"f_over_mu_" + length_unit, m.strength.value},
                                         {"f_over_mu_" + length_unit + "_stderr", m.strength.error},
                                         {"units", {{"eta", "1"}, {"xi", "f/mu"}, {"alpha", "1"}}}};
    return json.dump(2) + "\n";
}

} // namespace

void take_fitted_medium(Session& session, const FitResults& results, const FitPlan& plan) {
    const FittedMedium m = medium_of(results.report);
    require_known(m);
    session.directory.write("medium.json", medium_json(m, plan.keys.length_unit));
    session.log->info(
        "fitted medium: eta = {:.4g} +- {:.2g}, xi = {:.4g} +- {:.2g} f/mu, alpha = {:.4g} +- {:.2g}",
        m.eta.value, m.eta.error, m.xi.value, m.xi.error, m.alpha.value, m.alpha.error);
    session.use_medium(m.eta.value, m.xi.value);
}

} // namespace rodwake::cli
