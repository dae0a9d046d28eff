#include "check_fit_data.hpp"

#include "suggest.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rodwake::scene {

namespace {

using Report = std::function<void(const std::string&, const std::string&)>;

bool has_profiles(const Fit& fit, const char* component, bool fitted_only) {
    return std::ranges::any_of(fit.profiles, [&](const FitProfile& p) {
        return (!component || p.component == component) && (!fitted_only || p.role == FitRole::fit);
    });
}

bool has_wake(const Fit& fit) { return fit_has(fit, "f_over_mu") || fit_has(fit, "f2d_over_mu"); }

bool has_coupling(const Fit& fit) {
    return std::ranges::any_of(rods::coupling_list,
                               [&](const rods::Coupling& c) { return fit_has(fit, std::string(c.name)); });
}

/// What the data must hold for a parameter to mean something; empty: it does.
std::string lacks(const Fit& fit, const std::string& name) {
    const bool fitted_only = fit_is_free(fit, name); // a fixed one may belong to a prediction
    const char* role = fitted_only ? " with role = \"fit\"" : "";
    const bool tracks = !fit.trajectories.empty(), maps = !fit.maps.empty();
    if (is_map_parameter(name))
        return maps ? "" : "[[fit.maps]]";
    if (maps && (name == "offset" || name == "offset_y"))
        return "";
    if (rods::find_coupling(name))
        return tracks ? "" : "[[fit.trajectories]]";
    if (name == "offset")
        return has_profiles(fit, "Ux", fitted_only) ? "" : fmt::format("a profile of Ux{}", role);
    if (name == "offset_y")
        return has_profiles(fit, "Uy", fitted_only) ? "" : fmt::format("a profile of Uy{}", role);
    if (name == "eta" || name == "xi" || name == "alpha")
        return tracks || has_profiles(fit, nullptr, fitted_only) ? ""
                                                                 : fmt::format("[[fit.profiles]]{}", role);
    if (name == "f_over_mu" && fit_has(fit, "alpha") && tracks && !has_profiles(fit, nullptr, fitted_only))
        return "[[fit.profiles]]; tracks alone give alpha by itself";
    return has_profiles(fit, nullptr, fitted_only) ? "" : fmt::format("[[fit.profiles]]{}", role);
}

std::string place_of(const Fit& fit, const std::string& name) {
    const auto at = std::ranges::find(fit.parameters, name);
    if (at != fit.parameters.end())
        return fmt::format("fit.parameters.{}", at - fit.parameters.begin());
    return (fit.fixed.contains(name) ? "fit.fixed." : "fit.tied.") + name;
}

void wanted(const Fit& fit, const Report& report) {
    if (!has_profiles(fit, nullptr, true) && fit.trajectories.empty() && fit.maps.empty())
        return report("fit",
                      fit.profiles.empty()
                          ? "[fit] has no data: give [[fit.profiles]], [[fit.maps]] or [[fit.trajectories]]"
                          : "[fit] has no data to fit: every one of [[fit.profiles]] has role = \"predict\"");
    for (const std::string& name : fit_used(fit))
        if (const std::string what = lacks(fit, name); !what.empty())
            report(place_of(fit, name), fmt::format("no data depend on {}: it needs {}", name, what));
}

void needed(const Fit& fit, const Report& report) {
    const auto need = [&](bool there, const std::string& text) {
        if (!there)
            report("fit.parameters", text + " (in fit.parameters, fit.fixed or fit.tied)");
    };
    const bool profiles = !fit.profiles.empty(), tracks = !fit.trajectories.empty();
    if (!profiles && !tracks)
        return;
    const bool xi = fit_has(fit, "xi"), alpha = fit_has(fit, "alpha");
    need(!profiles || has_wake(fit), "profiles need f_over_mu or f2d_over_mu");
    need(!tracks || has_coupling(fit), "trajectories need kappa, gamma1 or gamma2");
    if (has_wake(fit) || has_coupling(fit)) {
        need(fit_has(fit, "eta"), "the field needs eta");
        need(xi || alpha, "the field needs xi or alpha");
    }
    need(!(xi && alpha), "give xi or alpha = f_over_mu/xi, not both");
    need(!profiles || !alpha || fit_has(fit, "f_over_mu"), "alpha = f_over_mu/xi needs f_over_mu");
    need(!(profiles && tracks && xi),
         "profiles and trajectories together need alpha in place of xi, which is in the "
         "profiles' unit for the ones and in f/mu for the others");
}

void model(const Fit& fit, const Report& report) {
    const Fit unset;
    const auto of_profiles = [&](bool given, const char* name) {
        if (given && fit.profiles.empty())
            report(std::string("fit.") + name,
                   fmt::format("{} belongs to [[fit.profiles]]; there are none", name));
    };
    of_profiles(fit.core != unset.core, "core");
    of_profiles(fit.independent_spacing.has_value() && fit.maps.empty(), "independent_spacing");
    of_profiles(fit.heading != unset.heading, "heading");
    if (fit.heading != unset.heading && !fit.box)
        report("fit.heading", "heading is that of the rod against the sides of box; there is no box");
    if (fit.search.loss_width != unset.search.loss_width && fit.search.loss == fitting::Loss::squares)
        report("fit.loss_width", "loss_width belongs to loss = \"huber\" and \"cauchy\" only");
    if (fit.length_unit.empty())
        report("fit.length_unit", "length_unit must not be empty");
}

void trajectory(const FitTrajectory& t, const std::string& path, const Report& report) {
    if (t.sigma_position.has_value() != t.sigma_heading.has_value())
        report(path, "sigma_position and sigma_heading come together");
    if (t.contact_time && !t.contact_distance)
        report(path + ".contact_time", "contact_time needs contact_distance, at which the rods meet");
    if (t.sigma_contact && !t.contact_time)
        report(path + ".sigma_contact", "sigma_contact belongs to contact_time");
}

void profile(const FitProfile& p, const std::string& path, const Report& report) {
    if (p.range.size() == 2 && !(p.range[0] < p.range[1]))
        report(path + ".range", fmt::format("range must go from a lower to a higher place; it is [{}, {}]",
                                            p.range[0], p.range[1]));
}

} // namespace

void check_fit_data(const Fit& fit, const Report& report) {
    wanted(fit, report);
    needed(fit, report);
    model(fit, report);
    for (std::size_t i = 0; i < fit.profiles.size(); ++i)
        profile(fit.profiles[i], fmt::format("fit.profiles.{}", i), report);
    for (std::size_t i = 0; i < fit.trajectories.size(); ++i)
        trajectory(fit.trajectories[i], fmt::format("fit.trajectories.{}", i), report);
}

} // namespace rodwake::scene
