#include "fit_map_json.hpp"
#include "run/values_json.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;

/// name -> number, of the free parameters.
ordered_json of_free(const fitting::Report& report, const std::vector<double>& values) {
    ordered_json out = ordered_json::object();
    for (const std::size_t i : report.free)
        out[report.estimates[i].name] = finite_or_null(values[i]);
    return out;
}

ordered_json mask_json(const fitting::MapMask& mask) {
    return {{"strip", mask.strip}, {"radius", mask.radius}, {"sector", {mask.from, mask.to}}};
}

ordered_json estimates_json(const fitting::Report& report) {
    ordered_json out = ordered_json::object();
    for (const std::size_t i : report.free) {
        const fitting::Estimate& e = report.estimates[i];
        out[e.name] = {
            {"value", finite_or_null(e.value)},
            {"stderr", has_error(report, e) ? finite_or_null(e.standard_error) : ordered_json(nullptr)}};
    }
    return out;
}

ordered_json errors_json(const FitSystematics& s, const fitting::Report& report, std::size_t i) {
    const fitting::Estimate& e = report.estimates[i];
    const auto part = [&](const std::vector<double>& errors) {
        return errors.empty() ? ordered_json(nullptr) : finite_or_null(errors[i]);
    };
    return {{"value", finite_or_null(e.value)},
            {"curvature", has_error(report, e) ? finite_or_null(e.standard_error) : ordered_json(nullptr)},
            {"held", part(s.held_error)},
            {"masks", part(s.mask_spread)},
            {"jackknife", part(s.jackknife)},
            {"total", part(s.total)}};
}

} // namespace

ordered_json map_json(const FitPlan& plan, const FitResults& results, std::size_t i) {
    const FitMapData& map = plan.maps[i];
    return {{"name", map.name},
            {"medium", "orthotropic"},
            {"file", map.file.string()},
            {"data", fmt::format("fit_map_{}.csv", i)},
            {"bins", map.data.bins()},
            {"used", results.maps[i].bins},
            {"box", {map.data.lx, map.data.ly}},
            {"speed", map.data.speed},
            {"independent", map.data.independent},
            {"mirrored", map.mirrored},
            {"mask", mask_json(plan.mask)},
            {"chi2", finite_or_null(results.maps[i].chi2)}};
}

ordered_json systematics_json(const FitPlan& plan, const FitResults& results) {
    const FitSystematics& s = results.systematics;
    if (s.total.empty())
        return nullptr;
    ordered_json out = {{"errors", ordered_json::object()}};
    for (const std::size_t i : results.report.free)
        out["errors"][results.report.estimates[i].name] = errors_json(s, results.report, i);
    for (const char* list : {"held", "masks", "runs"})
        out[list] = ordered_json::array();
    for (const auto& one : s.held)
        out["held"].push_back(
            {{"name", one.name}, {"error", one.error}, {"change", of_free(results.report, one.change)}});
    for (const auto& one : s.masks) {
        ordered_json mask = mask_json(one.mask);
        mask.update({{"residuals", one.residuals},
                     {"chi2", finite_or_null(one.report.chi2)},
                     {"dof", one.report.dof},
                     {"parameters", estimates_json(one.report)}});
        out["masks"].push_back(mask);
    }
    for (const auto& one : s.runs)
        out["runs"].push_back({{"without", plan.maps[one.map].file.string()},
                               {"parameters", of_free(results.report, one.values)}});
    return out;
}

} // namespace rodwake::app
