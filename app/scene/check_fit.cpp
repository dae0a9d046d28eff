#include "check.hpp"

#include "diagnostics.hpp"
#include "fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::scene {

namespace {

/// Each parameter is free, fixed or tied, and only one of them; ties are to free ones.
void roles(const Fit& fit, const Report& report) {
    for (const auto& [name, value] : fit.fixed)
        if (fit_is_free(fit, name))
            report(
                "fit.fixed." + name,
                fmt::format("{0} is fitted (fit.parameters) and fixed: leave it out of one of them", name));
    for (const auto& [name, tie] : fit.tied) {
        if (fit_is_free(fit, name) || fit.fixed.contains(name))
            report("fit.tied." + name, fmt::format("{} is tied and also {}: leave it out of one of them",
                                                   name, fit_is_free(fit, name) ? "fitted" : "fixed"));
        if (!fit_is_free(fit, tie.to))
            report("fit.tied." + name,
                   fmt::format("{} is tied to {}, which is not fitted; fit.parameters has {}", name, tie.to,
                               comma_list(fit.parameters)));
    }
    const auto unused = [&](const std::string& table, const std::string& name) {
        if (!fit_has(fit, name)) // of one that is held for now they may stay
            report("fit." + table + "." + name,
                   fmt::format("fit.{} has {}, which is not in fit.parameters, fit.fixed or fit.tied", table,
                               name));
    };
    for (const auto& [name, value] : fit.start)
        unused("start", name);
    for (const auto& [name, bounds] : fit.bounds)
        unused("bounds", name);
}

/// The physics bounds values from below: eta > -1; lengths, alpha and moduli > 0.
void value(const std::string& path, const std::string& name, double value, const Report& report) {
    static const std::vector<std::string> positive = {"xi",  "alpha",     "c11",           "c22",
                                                      "c66", "drag_area", "stall_overlap", "mobility_ratio"};
    const double lowest = name == "eta" ? -1.0 : contains(positive, name) ? 0.0 : -HUGE_VAL;
    if (!(value > lowest))
        report(path, fmt::format("{} = {:g}: {} must be above {:g}", path, value, name, lowest));
}

void values(const Fit& fit, const Report& report) {
    for (const auto& [name, number] : fit.start)
        value("fit.start." + name, name, number, report);
    for (const auto& [name, number] : fit.fixed)
        value("fit.fixed." + name, name, number, report);
    for (const auto& [name, interval] : fit.bounds)
        value("fit.bounds." + name, name, interval.low, report);
    for (std::size_t i = 0; i < fit.compare.size(); ++i)
        for (const auto& [name, number] : fit.compare[i].values)
            value(fmt::format("fit.compare.{}.values.{}", i, name), name, number, report);
}

void bounds(const Fit& fit, const Report& report) {
    for (const auto& [name, interval] : fit.bounds)
        if (!(interval.low < interval.high))
            report("fit.bounds." + name,
                   fmt::format("bounds of {} are reversed: low = {:g} must be below high = {:g}", name,
                               interval.low, interval.high));
    for (const auto& name : fit.parameters) {
        const auto bounds = fit_bounds(fit, name);
        const auto given = fit.start.find(name);
        const bool by_default = given == fit.start.end();
        const double start = by_default ? fit_default_start(fit, name) : given->second;
        if (!bounds || (bounds->low <= start && start <= bounds->high) || !(bounds->low < bounds->high))
            continue;
        report((by_default ? "fit.bounds." : "fit.start.") + name,
               fmt::format("{} starts at {:g}{}, outside its {}bounds [{:g}, {:g}]: change fit.start or "
                           "fit.bounds",
                           name, start, by_default ? " (default)" : "",
                           fit.bounds.contains(name) ? "" : "default ", bounds->low, bounds->high));
    }
    for (const auto& name : fit.parameters)
        if (fitting::is_global(fit.search.algorithm) && !fit_bounds(fit, name))
            report("fit.method",
                   fmt::format("this method searches all over the bounds, and {0} has none: give "
                               "fit.bounds.{0} = [low, high]",
                               name));
}

void compare(const Fit& fit, const Report& report) {
    for (std::size_t i = 0; i < fit.compare.size(); ++i) {
        const auto& values = fit.compare[i].values;
        const std::string path = fmt::format("fit.compare.{}.values", i);
        if (values.empty() == !fit.compare[i].line.has_value())
            report(path, "give values, or line: one of them");
        if (const auto line = fit.compare[i].line; line && !fit_is_isotropic(fit))
            report(fmt::format("fit.compare.{}.line", i),
                   "line belongs to fits of maps with f_over_mu and eta");
        else if (line && *line >= std::ssize(fit.profiles))
            report(fmt::format("fit.compare.{}.line", i),
                   fmt::format("there is no profile {}: fit.profiles has {} (numbered from 0)", *line,
                               fit.profiles.size()));
        if (values.contains("xi") && values.contains("alpha"))
            report(path, "give xi or alpha = f_over_mu/xi, not both");
        for (const auto& [name, number] : values)
            if (!fit_has(fit, name) && !((name == "xi" || name == "alpha") && fit_knows_xi(fit)))
                report(fmt::format("{}.{}", path, name),
                       fmt::format("{} is not a parameter of this fit; it has {}", name,
                                   comma_list(fit_used(fit))));
    }
}

void medium(const Scene& scene, const Report& report) {
    if (!scene.medium || !scene.medium->fitted)
        return;
    const std::string path = "medium.fitted";
    if (!scene.fit)
        return report(path, "medium.fitted = true needs [fit], which eta and xi are taken from");
    const Fit& fit = *scene.fit;
    const bool known = fit_has(fit, "f_over_mu") && fit_has(fit, "eta") && fit_knows_xi(fit);
    if (!known)
        report(path,
               fmt::format(
                   "medium.fitted = true needs f_over_mu, eta and xi or alpha in [fit] (fitted, fixed or "
                   "tied; of maps also drag_area); it has {}",
                   comma_list(fit_used(fit))));
}

} // namespace

void check_fit(const Scene& scene, const Report& report) {
    medium(scene, report);
    if (!scene.fit)
        return;
    const Fit& fit = *scene.fit;
    if (fit.box && fit.box->square() && scene.granular &&
        (scene.granular->box.fit || scene.granular->box.x != scene.granular->box.y))
        report("fit.box",
               "is one side and granular.box is a rectangle: give its two sides (rodwake check prints "
               "those that \"fit\" finds), or leave fit.box out (infinite plane)");
    roles(fit, report);
    values(fit, report);
    bounds(fit, report);
    // eta, xi and alpha stand in the default list: they are linear where their bounds do not allow more.
    for (std::size_t i = 0; i < fit.log.size(); ++i) {
        const std::string& name = fit.log[i];
        const std::string path = fmt::format("fit.log.{}", i);
        if (contains(Fit{}.log, name))
            continue;
        if (!fit_is_free(fit, name))
            report(path, fmt::format("{} is not among fit.parameters", name));
        else if (!fit_in_log(fit, name))
            report(path,
                   fmt::format("a search in the logarithm of {0} needs bounds above 0: give fit.bounds.{0} = "
                               "[low, high]",
                               name));
    }
    for (std::size_t i = 0; i < fit.likelihood.size(); ++i)
        if (!fit_is_free(fit, fit.likelihood[i]))
            report(fmt::format("fit.likelihood.{}", i),
                   fmt::format("{} is not among fit.parameters: nothing to profile", fit.likelihood[i]));
    compare(fit, report);
    check_fit_data(fit, report);
    for (const char* name : {"stall_overlap", "mobility_ratio"})
        if (fit_has(fit, name) && !scene.body)
            report("fit.parameters", fmt::format("{} is of rods with bodies: give [body]", name));
    for (const char* name : {"D_r", "D_t"})
        if (fit_has(fit, name) && scene.body && !fit.trajectories.empty())
            report("fit.parameters",
                   fmt::format("{} of rods with bodies cannot be fitted, because their contacts are not "
                               "linear in what noise moves them: leave it out, or [body]",
                               name));
    check_fit_maps(scene, report);
    check_posterior(fit, report);
}

namespace {

bool has_profiles(const Fit& fit, const char* component, bool fitted_only) {
    return std::ranges::any_of(fit.profiles, [&](const FitProfile& p) {
        return (!component || p.component == component) && (!fitted_only || p.role == FitRole::fit);
    });
}

bool has_wake(const Fit& fit) { return fit_has(fit, "f_over_mu") || fit_has(fit, "f2d_over_mu"); }

bool has_coupling(const Fit& fit) { return std::ranges::any_of(fit_used(fit), rods::turns_in_wakes); }

/// What the data must hold for a parameter to mean something; empty: it does.
std::string lacks(const Fit& fit, const std::string& name) {
    const bool fitted_only = fit_is_free(fit, name); // a fixed one may belong to a prediction
    const char* role = fitted_only ? " with role = \"fit\"" : "";
    const bool tracks = !fit.trajectories.empty(), maps = !fit.maps.empty();
    if (is_map_parameter(name))
        return maps ? "" : "[[fit.maps]]";
    if (fit_is_isotropic(fit) && (name == "f_over_mu" || name == "eta" || name == "xi" || name == "alpha"))
        return "";
    if (maps && (name == "offset" || name == "offset_y"))
        return "";
    if (rods::find_coupling(name) || rods::find_other_turning(name) || rods::is_noise(name) ||
        name == "stall_overlap" || name == "mobility_ratio")
        return tracks ? "" : "[[fit.trajectories]]";
    if (name == "offset")
        return has_profiles(fit, "Ux", fitted_only) ? "" : fmt::format("a profile of Ux{}", role);
    if (name == "offset_y")
        return has_profiles(fit, "Uy", fitted_only) ? "" : fmt::format("a profile of Uy{}", role);
    if (name == "eta" || name == "xi" || name == "alpha")
        return tracks || has_profiles(fit, nullptr, fitted_only) ? ""
                                                                 : fmt::format("[[fit.profiles]]{}", role);
    if (name == "f_over_mu" && fit_has(fit, "alpha") && tracks && !has_profiles(fit, nullptr, fitted_only))
        return "[[fit.profiles]]; tracks alone determine only alpha";
    return has_profiles(fit, nullptr, fitted_only) ? "" : fmt::format("[[fit.profiles]]{}", role);
}

void wanted(const Fit& fit, const Report& report) {
    if (!has_profiles(fit, nullptr, true) && fit.trajectories.empty() && fit.maps.empty())
        return report("fit",
                      fit.profiles.empty()
                          ? "[fit] has no data: give [[fit.profiles]], [[fit.maps]] or [[fit.trajectories]]"
                          : "[fit] has no data to fit: every one of [[fit.profiles]] has role = \"predict\"");
    if (fit.parameters.empty() && !(fit.profiles.empty() && fit.maps.empty()))
        report(
            "fit.parameters",
            "fit.parameters is empty: name at least one parameter (only fits of tracks alone may have none)");
    for (const std::string& name : fit_used(fit))
        if (const std::string what = lacks(fit, name); !what.empty()) {
            const auto at = std::ranges::find(fit.parameters, name);
            report(at != fit.parameters.end()
                       ? fmt::format("fit.parameters.{}", at - fit.parameters.begin())
                       : (fit.fixed.contains(name) ? "fit.fixed." : "fit.tied.") + name,
                   fmt::format("no data depend on {}: it needs {}", name, what));
        }
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
    const bool noise = fit_has(fit, "D_r") || fit_has(fit, "D_t");
    const bool bodies = fit_has(fit, "stall_overlap") || fit_has(fit, "mobility_ratio");
    if (tracks && !has_coupling(fit) && !fit_has(fit, "gamma_rows") && !noise && !bodies &&
        !fit.parameters.empty())
        report("fit.parameters", "[[fit.trajectories]]: nothing turns the rods. Put kappa, gamma1, gamma2, "
                                 "gamma_flow or gamma_rows into fit.parameters, fit.fixed or fit.tied");
    need(!fit_has(fit, "rows_direction") || fit_has(fit, "gamma_rows"), "rows_direction needs gamma_rows");
    if (has_wake(fit) || has_coupling(fit)) {
        need(fit_has(fit, "eta"), "the field needs eta");
        need(fit_knows_xi(fit), "the field needs xi or alpha");
    }
    need(!(xi && alpha), "give xi or alpha = f_over_mu/xi, not both");
    need(!profiles || !alpha || fit_has(fit, "f_over_mu"), "alpha = f_over_mu/xi needs f_over_mu");
    need(!(profiles && tracks && xi),
         "profiles and trajectories together need alpha instead of xi, because xi would be in the profiles' "
         "unit for the former and in f/mu for the latter");
}

/// Reports a key of [fit] that is given without the data it belongs to.
void stray(bool given, const char* name, const char* data, const Report& report) {
    if (given)
        report(std::string("fit.") + name,
               fmt::format("{} belongs to [[fit.{}]]; there are none", name, data));
}

} // namespace

void check_fit_data(const Fit& fit, const Report& report) {
    wanted(fit, report);
    needed(fit, report);
    // Noise has a likelihood of its own, which needs the errors of the measurement.
    if (fit_has(fit, "D_r") || fit_has(fit, "D_t")) {
        for (std::size_t i = 0; i < fit.trajectories.size(); ++i)
            if (!fit.trajectories[i].sigma_position || !fit.trajectories[i].sigma_heading)
                report(fmt::format("fit.trajectories.{}", i),
                       "fitting D_r or D_t needs known measurement errors: set sigma_position and "
                       "sigma_heading in [[fit.trajectories]]");
        if (fit.search.loss != fitting::Loss::squares)
            report("fit.loss", "D_r and D_t can only be fitted with loss = \"squares\" (Gaussian errors)");
    }

    const Fit unset;
    if (fit.profiles.empty()) {
        stray(fit.core != unset.core, "core", "profiles", report);
        stray(fit.independent_spacing && fit.maps.empty(), "independent_spacing", "profiles", report);
        stray(fit.heading != unset.heading, "heading", "profiles", report);
    }
    if (fit.heading != unset.heading && !fit.box)
        report("fit.heading", "heading is the angle of the rod to the sides of the periodic box: give "
                              "fit.box, or leave heading out");
    if (fit.search.loss_width != unset.search.loss_width && fit.search.loss == fitting::Loss::squares)
        report("fit.loss_width", "loss_width belongs to loss = \"huber\" and \"cauchy\" only");
    if (fit.length_unit.empty())
        report("fit.length_unit", "length_unit must not be empty");
    for (std::size_t i = 0; i < fit.profiles.size(); ++i)
        if (const std::vector<double>& range = fit.profiles[i].range;
            range.size() == 2 && !(range[0] < range[1]))
            report(fmt::format("fit.profiles.{}.range", i),
                   fmt::format("range must go from a lower to a higher position; it is [{}, {}]", range[0],
                               range[1]));
    for (std::size_t i = 0; i < fit.trajectories.size(); ++i) {
        const FitTrajectory& t = fit.trajectories[i];
        const std::string path = fmt::format("fit.trajectories.{}", i);
        if (t.sigma_position.has_value() != t.sigma_heading.has_value())
            report(path, "sigma_position and sigma_heading come together");
        if (t.contact_time && !t.contact_distance)
            report(path + ".contact_time", "contact_time needs contact_distance, at which the rods meet");
        if (t.sigma_contact && !t.contact_time)
            report(path + ".sigma_contact", "sigma_contact belongs to contact_time");
    }
}

namespace {

void needed_by_maps(const Fit& fit, const Report& report) {
    if (fit.maps.empty())
        return;
    const auto need = [&](bool there, const char* text) {
        if (!there)
            report("fit.parameters", std::string(text) + " (in fit.parameters, fit.fixed or fit.tied)");
    };
    if (fit_is_isotropic(fit)) {
        for (const char* name : {"amplitude", "force", "c11", "c22", "c12", "zeta", "rho", "eta_s"})
            need(!fit_has(fit, name),
                 fmt::format("maps with f_over_mu and eta are in units of mu: leave out {}", name).c_str());
        need(fit_has(fit, "f_over_mu"), "maps with eta need f_over_mu");
        need(fit_has(fit, "xi") + fit_has(fit, "alpha") + fit_has(fit, "drag_area") < 2,
             "give one of xi, alpha and drag_area");
        if (!fit.trajectories.empty() || has_profiles(fit, nullptr, true))
            report("fit.parameters",
                   "maps fitted by f_over_mu and eta cannot be combined with other fitted data: set role = "
                   "\"predict\" in [[fit.profiles]], and leave out [[fit.trajectories]]");
        return;
    }
    need(!fit_has(fit, "drag_area"), "drag_area belongs to maps with f_over_mu and eta");
    constexpr std::array sources = {"force", "p_xx", "p_yy", "q_xxx", "q_xyy", "q_yxy"};
    need(std::ranges::any_of(sources, [&](const char* name) { return fit_has(fit, name); }),
         "maps need force, p_xx, p_yy, q_xxx, q_xyy or q_yxy: without a source there is no displacement");
    need(!fit_has(fit, "amplitude") || fit_has(fit, "force"),
         "amplitude scales the predicted monopole force: also give force");
    for (const char* name : {"c11", "c22", "c12", "c66"})
        need(fit_has(fit, name), fmt::format("maps need {}", name).c_str());
}

} // namespace

void check_fit_maps(const Scene& scene, const Report& report) {
    const Fit& fit = *scene.fit;
    if (fit.measured_drag) {
        const std::string path = "fit.measured_drag", name = "drag_area";
        if (fit_is_free(fit, name) || fit.fixed.contains(name) || fit.tied.contains(name))
            report(path, name + " is measured and also fitted, fixed or tied: leave it out of one of them");
        if (!scene.measure || !scene.measure->mechanics)
            report(path, name + " is measured by measure.mechanics, which this scene does not set");
    }
    const Fit unset;
    if (fit.maps.empty()) {
        stray(fit.rod_length != unset.rod_length, "rod_length", "maps", report);
        stray(fit.source_width != unset.source_width, "source_width", "maps", report);
        stray(!fit.masks.empty(), "masks", "maps", report);
    }
    needed_by_maps(fit, report);
    for (const auto& [name, error] : fit.fixed_errors) {
        const std::string path = "fit.fixed_errors." + name;
        if (!fit.fixed.contains(name))
            report(path,
                   fmt::format("{} is not in fit.fixed: only a value that is held has an error of its own",
                               name));
        else if (!(error > 0.0))
            report(path,
                   fmt::format("{} = {:g}: a standard error must be above 0; leave it out if the value is "
                               "exact",
                               path, error));
    }
    for (std::size_t i = 0; i < fit.masks.size(); ++i)
        if (const std::vector<double>& sector = fit.masks[i].sector;
            sector.size() == 2 &&
            !(sector[0] >= 0.0 && sector[0] < sector[1] && sector[1] <= std::numbers::pi + 1e-9))
            report(
                fmt::format("fit.masks.{}.sector", i),
                fmt::format("sector must go from a lower to a higher angle within 0 and 180 deg (pi rad); it "
                            "is [{:g}, {:g}] rad",
                            sector[0], sector[1]));
    for (std::size_t i = 0; i < fit.maps.size(); ++i)
        for (const double side : fit.maps[i].box)
            if (const std::string path = fmt::format("fit.maps.{}.box", i); !(side > 0.0))
                report(path, fmt::format("{}: a side is {:g}; both must be above 0", path, side));
}

} // namespace rodwake::scene
