#include "check_fit_maps.hpp"

#include "suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

namespace rodwake::scene {

namespace {

using Report = std::function<void(const std::string&, const std::string&)>;

void belongs_to_maps(const Fit& fit, const Report& report) {
    const Fit unset;
    const auto only = [&](bool given, const char* name) {
        if (given && fit.maps.empty())
            report(std::string("fit.") + name,
                   fmt::format("{} belongs to [[fit.maps]]; there are none", name));
    };
    only(fit.rod_length != unset.rod_length, "rod_length");
    only(fit.source_width != unset.source_width, "source_width");
    only(!fit.masks.empty(), "masks");
}

void needed_by_maps(const Fit& fit, const Report& report) {
    if (fit.maps.empty())
        return;
    const auto need = [&](bool there, const char* text) {
        if (!there)
            report("fit.parameters", std::string(text) + " (in fit.parameters, fit.fixed or fit.tied)");
    };
    constexpr std::array sources = {"force", "p_xx", "p_yy", "q_xxx", "q_xyy", "q_yxy"};
    need(std::ranges::any_of(sources, [&](const char* name) { return fit_has(fit, name); }),
         "maps need force, p_xx, p_yy, q_xxx, q_xyy or q_yxy: without a source there is no displacement");
    need(!fit_has(fit, "amplitude") || fit_has(fit, "force"),
         "amplitude is the monopole over its prediction: it needs force, which it multiplies");
    for (const char* name : {"c11", "c22", "c12", "c66"})
        need(fit_has(fit, name), fmt::format("maps need {}", name).c_str());
}

void fixed_errors(const Fit& fit, const Report& report) {
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
}

void mask(const FitMask& one, const std::string& path, const Report& report) {
    if (one.sector.size() == 2 &&
        !(one.sector[0] >= 0.0 && one.sector[0] < one.sector[1] && one.sector[1] <= std::numbers::pi + 1e-9))
        report(
            path + ".sector",
            fmt::format("sector must go from a lower to a higher angle within 0 and 180 deg (pi rad); it is "
                        "[{:g}, {:g}] rad",
                        one.sector[0], one.sector[1]));
}

void map(const FitMap& one, const std::string& path, const Report& report) {
    for (const double side : one.box)
        if (!(side > 0.0))
            report(path + ".box", fmt::format("{}.box: a side is {:g}; both must be above 0", path, side));
}

} // namespace

void check_fit_maps(const Fit& fit, const Report& report) {
    belongs_to_maps(fit, report);
    needed_by_maps(fit, report);
    fixed_errors(fit, report);
    for (std::size_t i = 0; i < fit.masks.size(); ++i)
        mask(fit.masks[i], fmt::format("fit.masks.{}", i), report);
    for (std::size_t i = 0; i < fit.maps.size(); ++i)
        map(fit.maps[i], fmt::format("fit.maps.{}", i), report);
}

} // namespace rodwake::scene
