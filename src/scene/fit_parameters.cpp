// What [fit] says of a parameter, with its defaults.

#include "rodwake/scene/fit.hpp"

#include "suggest.hpp"

#include <algorithm>
#include <iterator>

namespace rodwake::scene {

namespace {

bool is_of_medium(const std::string& name) { return name == "eta" || name == "xi" || name == "alpha"; }

} // namespace

const std::vector<std::string>& fit_parameter_names() {
    static const std::vector<std::string> names = {"f_over_mu", "f2d_over_mu", "eta",    "xi",
                                                   "alpha",     "x0",          "offset", "offset_y",
                                                   "kappa",     "gamma1",      "gamma2"};
    return names;
}

double fit_default_start(const Fit& fit, const std::string& parameter) {
    if (parameter == "xi" && fit.profiles.empty()) // tracks alone: in f/mu, so 1/alpha
        return 1.0;
    static const std::map<std::string, double> starts = {
        {"f_over_mu", 1.0}, {"eta", 1.0}, {"xi", 10.0}, {"alpha", 1.0}, {"kappa", 1.0}};
    const auto it = starts.find(parameter);
    return it == starts.end() ? 0.0 : it->second;
}

std::optional<Interval> fit_bounds(const Fit& fit, const std::string& parameter) {
    if (const auto it = fit.bounds.find(parameter); it != fit.bounds.end())
        return it->second;
    return is_of_medium(parameter) ? std::optional(Interval{1e-6, 1e6}) : std::nullopt;
}

bool fit_in_log(const Fit& fit, const std::string& parameter) {
    const auto bounds = fit_bounds(fit, parameter);
    return contains(fit.log, parameter) && bounds && bounds->low > 0.0;
}

bool fit_is_free(const Fit& fit, const std::string& parameter) { return contains(fit.parameters, parameter); }

bool fit_has(const Fit& fit, const std::string& parameter) {
    return fit_is_free(fit, parameter) || fit.fixed.contains(parameter) || fit.tied.contains(parameter);
}

std::vector<std::string> fit_used(const Fit& fit) {
    std::vector<std::string> used;
    std::ranges::copy_if(fit_parameter_names(), std::back_inserter(used),
                         [&](const std::string& name) { return fit_has(fit, name); });
    return used;
}

} // namespace rodwake::scene
