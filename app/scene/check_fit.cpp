#include "check_fit.hpp"

#include "check_fit_data.hpp"
#include "check_fit_maps.hpp"
#include "fields.hpp"
#include "suggest.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rodwake::scene {

namespace {

using Report = std::function<void(const std::string&, const std::string&)>;

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

/// Where the physics allows a value: eta > -1; lengths, alpha and moduli > 0.
double lowest(const std::string& name) {
    static const std::vector<std::string> positive = {"xi", "alpha", "c11", "c22", "c66"};
    return name == "eta" ? -1.0 : contains(positive, name) ? 0.0 : -HUGE_VAL;
}

void value(const std::string& path, const std::string& name, double value, const Report& report) {
    if (!(value > lowest(name)))
        report(path, fmt::format("{} = {:g}: {} must be above {:g}", path, value, name, lowest(name)));
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

void start_within(const Fit& fit, const std::string& name, const Report& report) {
    const auto bounds = fit_bounds(fit, name);
    const auto given = fit.start.find(name);
    const double start = given == fit.start.end() ? fit_default_start(fit, name) : given->second;
    if (!bounds || (bounds->low <= start && start <= bounds->high) || !(bounds->low < bounds->high))
        return;
    const bool by_default = !fit.bounds.contains(name);
    report(
        given == fit.start.end() ? "fit.bounds." + name : "fit.start." + name,
        fmt::format("{} starts at {:g}{}, outside its {}bounds [{:g}, {:g}]: change fit.start or fit.bounds",
                    name, start, given == fit.start.end() ? " (default)" : "", by_default ? "default " : "",
                    bounds->low, bounds->high));
}

void bounds(const Fit& fit, const Report& report) {
    for (const auto& [name, interval] : fit.bounds)
        if (!(interval.low < interval.high))
            report("fit.bounds." + name,
                   fmt::format("bounds of {} are reversed: low = {:g} must be below high = {:g}", name,
                               interval.low, interval.high));
    for (const auto& name : fit.parameters)
        start_within(fit, name, report);
    for (const auto& name : fit.parameters)
        if (fitting::is_global(fit.search.algorithm) && !fit_bounds(fit, name))
            report("fit.method",
                   fmt::format("this method searches all over the bounds, and {0} has none: give "
                               "fit.bounds.{0} = [low, high]",
                               name));
}

/// eta, xi and alpha stand in the default list: they are linear where their bounds do not allow more.
void logarithms(const Fit& fit, const Report& report) {
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
}

void likelihood(const Fit& fit, const Report& report) {
    for (std::size_t i = 0; i < fit.likelihood.size(); ++i)
        if (!fit_is_free(fit, fit.likelihood[i]))
            report(fmt::format("fit.likelihood.{}", i),
                   fmt::format("{} is not among fit.parameters: nothing to profile", fit.likelihood[i]));
}

void compare(const Fit& fit, const Report& report) {
    const auto known = [&](const std::string& name) {
        const bool medium =
            (name == "xi" || name == "alpha") && (fit_has(fit, "xi") || fit_has(fit, "alpha"));
        return fit_has(fit, name) || medium;
    };
    for (std::size_t i = 0; i < fit.compare.size(); ++i) {
        const auto& values = fit.compare[i].values;
        const std::string path = fmt::format("fit.compare.{}.values", i);
        if (values.contains("xi") && values.contains("alpha"))
            report(path, "give xi or alpha = f_over_mu/xi, not both");
        for (const auto& [name, number] : values)
            if (!known(name))
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
    const bool known =
        fit_has(fit, "f_over_mu") && fit_has(fit, "eta") && (fit_has(fit, "xi") || fit_has(fit, "alpha"));
    if (!known)
        report(path,
               fmt::format(
                   "medium.fitted = true needs f_over_mu, eta and xi or alpha in [fit] (fitted, fixed or "
                   "tied); it has {}",
                   comma_list(fit_used(fit))));
}

void box(const Scene& scene, const Report& report) {
    if (!scene.fit->box || !scene.granular || !scene.fit->box->square())
        return;
    const BoxSize& bed = scene.granular->box;
    if (bed.fit || bed.x != bed.y)
        report("fit.box",
               "is one side and granular.box is a rectangle: give its two sides (rodwake check prints "
               "those that \"fit\" finds), or leave fit.box out (infinite plane)");
}

} // namespace

void check_fit(const Scene& scene, const Report& report) {
    medium(scene, report);
    if (!scene.fit)
        return;
    const Fit& fit = *scene.fit;
    box(scene, report);
    roles(fit, report);
    values(fit, report);
    bounds(fit, report);
    logarithms(fit, report);
    likelihood(fit, report);
    compare(fit, report);
    check_fit_data(fit, report);
    check_fit_maps(fit, report);
}

} // namespace rodwake::scene
