#include "rodwake/elastic/medium.hpp"

#include "rodwake/core/error.hpp"

#include <cmath>
#include <sstream>
#include <string>

namespace rodwake::elastic {

namespace {

void require(bool legal, const std::string& name, double value, const std::string& range) {
    if (legal)
        return;
    std::ostringstream message;
    message << name << " = " << value << ": must be " << range;
    throw InputError(message.str());
}

} // namespace

void validate(const Medium& medium) {
    require(medium.eta > -1.0 && medium.eta <= Medium::max_eta, "eta", medium.eta,
            "> -1 (the longitudinal modulus (1 + eta) mu must be positive) and at most 1e12");
    require(medium.xi >= Medium::min_xi && medium.xi <= Medium::max_xi, "xi", medium.xi,
            "> 0, in [1e-30, 1e30]");
}

double eta_from_lame(double lame_lambda, double mu) {
    require(mu > 0.0, "mu", mu, "> 0");
    require(lame_lambda > -2.0 * mu, "lame_lambda", lame_lambda, "> -2 mu");
    return (lame_lambda + mu) / mu;
}

double eta_from_bulk_modulus(double bulk_modulus, double mu) {
    require(mu > 0.0, "mu", mu, "> 0");
    require(bulk_modulus > -mu, "bulk_modulus", bulk_modulus, "> -mu");
    return bulk_modulus / mu;
}

double eta_from_poisson_ratio(double ratio) {
    require(ratio > -1.0 && ratio < 1.0, "poisson_ratio", ratio, "between -1 and 1 (two dimensions)");
    return (1.0 + ratio) / (1.0 - ratio);
}

double poisson_ratio(double eta) {
    require(eta > -1.0, "eta", eta, "> -1");
    return (eta - 1.0) / (eta + 1.0);
}

double xi_from_alpha(double alpha, double f_over_mu) {
    require(alpha > 0.0 && std::isfinite(alpha), "alpha", alpha, "> 0 and finite");
    require(f_over_mu > 0.0 && std::isfinite(f_over_mu), "f_over_mu", f_over_mu, "> 0 and finite");
    return f_over_mu / alpha;
}

} // namespace rodwake::elastic
