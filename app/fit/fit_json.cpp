#include "fit_json.hpp"
#include "run/values_json.hpp"

#include "fit_map_json.hpp"
#include "rodwake/core/build_info.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;

/// A square by its side.
ordered_json sides(const std::optional<PeriodicBox>& box) {
    if (!box)
        return nullptr;
    return box->square() ? ordered_json(box->x) : ordered_json{box->x, box->y};
}

ordered_json numbers(const std::vector<double>& values) {
    ordered_json out = ordered_json::array();
    for (const double value : values)
        out.push_back(finite_or_null(value));
    return out;
}

/// name -> value of some parameters.
ordered_json named(const fitting::Report& report, const std::vector<std::size_t>& which,
                   const std::vector<double>& values) {
    ordered_json out = ordered_json::object();
    for (std::size_t k = 0; k < values.size(); ++k)
        out[report.estimates[which[k]].name] = finite_or_null(values[k]);
    return out;
}

std::vector<std::size_t> all_of(const fitting::Report& report) {
    std::vector<std::size_t> out(report.estimates.size());
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = i;
    return out;
}

/// A parameter that is fixed or held by a bound has no error.
ordered_json parameter_json(const scene::Fit& keys, const fitting::Parameter& p, const fitting::Estimate& e,
                            bool has_error) {
    const ordered_json none = nullptr;
    return {{"value", finite_or_null(e.value)},
            {"stderr", has_error ? finite_or_null(e.standard_error) : none},
            {"low", finite_or_null(e.low)},
            {"high", finite_or_null(e.high)},
            {"free", p.free()},
            {"fixed", p.fixed},
            {"tied_to", p.tied_to.empty() ? none : ordered_json(p.tied_to)},
            {"at_bound", e.at_lower   ? ordered_json("lower")
                         : e.at_upper ? ordered_json("upper")
                                      : none},
            {"unit", fit_unit(keys, p.name)},
            {"start", p.start},
            {"bounds", {finite_or_null(p.lower), finite_or_null(p.upper)}},
            {"log", p.transform == fitting::Transform::log}};
}

/// Null where one of the two has no error, or an infinite one: nothing is known of it then.
ordered_json correlation_json(const fitting::Report& report) {
    const auto known = [&](Eigen::Index k) {
        const fitting::Estimate& e = report.estimates[report.free[static_cast<std::size_t>(k)]];
        return has_error(report, e) && std::isfinite(e.standard_error);
    };
    const Eigen::MatrixXd& m = report.correlation;
    ordered_json rows = ordered_json::array();
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
        ordered_json row = ordered_json::array();
        for (Eigen::Index j = 0; j < m.cols(); ++j)
            row.push_back(i == j || (known(i) && known(j)) ? finite_or_null(m(i, j)) : ordered_json(nullptr));
        rows.push_back(row);
    }
    return rows;
}

ordered_json scale_factor_json(const std::optional<fitting::ScaleFactor>& e) {
    if (!e)
        return nullptr;
    return {{"scale", finite_or_null(e->scale)},
            {"stderr", finite_or_null(e->standard_error)},
            {"chi2", finite_or_null(e->chi2)},
            {"points", e->points}};
}

ordered_json start_json(const fitting::Report& report, const fitting::StartResult& s) {
    return {{"index", s.index},
            {"start", named(report, report.free, s.start)},
            {"end", named(report, report.free, s.end)},
            {"objective", finite_or_null(s.objective)},
            {"termination", s.termination},
            {"evaluations", s.evaluations}};
}

ordered_json profile_json(const FitPlan& plan, const FitResults& results, std::size_t i) {
    const scene::FitProfile& keys = plan.keys.profiles[i];
    const FitProfileResult& r = results.profiles[i];
    return {{"name", plan.profiles[i].name},
            {"medium", "isotropic"},
            {"file", plan.profiles[i].file.string()},
            {"component", keys.component},
            {"along", keys.along},
            {"at", keys.at},
            {"role", keys.role == scene::FitRole::fit ? "fit" : "predict"},
            {"points", r.used.size()},
            {"used", std::ranges::count(r.used, true)},
            {"independent", plan.profiles[i].data.independent},
            {"data", fmt::format("fit_profile_{}.csv", i)},
            {"curve", fmt::format("fit_curve_{}.csv", i)},
            {"chi2", finite_or_null(r.chi2)},
            {"excess", scale_factor_json(r.scale_factor)}};
}

ordered_json track_json(const FitPlan& plan, const FitResults& results, std::size_t i) {
    return {{"name", plan.tracks[i].name},
            {"file", plan.tracks[i].file.string()},
            {"rods", plan.tracks[i].rods},
            {"rows", plan.tracks[i].data.times.size()},
            {"independent", plan.tracks[i].data.independent},
            {"data", fmt::format("fit_trajectory_{}.csv", i)},
            {"rms_position", finite_or_null(results.tracks[i].rms_position)},
            {"rms_heading", finite_or_null(results.tracks[i].rms_heading)}};
}

ordered_json compare_json(const scene::FitCompare& keys, const FitResults& results,
                          const FitCompareResult& r) {
    ordered_json profiles = ordered_json::array();
    for (std::size_t i = 0; i < r.scale_factor.size(); ++i)
        profiles.push_back(
            {{"chi2", finite_or_null(r.profile_chi2[i])}, {"excess", scale_factor_json(r.scale_factor[i])}});
    return {{"name", keys.name},
            {"values", named(results.report, all_of(results.report), r.values)},
            {"chi2", finite_or_null(r.chi2)},
            {"profiles", profiles}};
}

void add_parameters(ordered_json& out, const FitPlan& plan, const FitResults& results) {
    out["parameters"] = ordered_json::object();
    for (std::size_t i = 0; i < results.report.estimates.size(); ++i) {
        const fitting::Estimate& e = results.report.estimates[i];
        out["parameters"][e.name] =
            parameter_json(plan.keys, plan.problem.parameters[i], e, has_error(results.report, e));
    }
    out["derived"] = ordered_json::object();
    for (const auto& [name, d] : results.derived)
        out["derived"][name] = {{"value", finite_or_null(d.value)},
                                {"stderr", finite_or_null(d.error)},
                                {"unit", fit_unit(plan.keys, name)}};
    out["free"] = ordered_json::array();
    for (const std::size_t i : results.report.free)
        out["free"].push_back(results.report.estimates[i].name);
    out["correlation"] = correlation_json(results.report);
}

void add_quality(ordered_json& out, const FitPlan& plan, const FitResults& results) {
    const fitting::Report& r = results.report;
    const fitting::Fit& fit = results.fit;
    out["chi2"] = finite_or_null(r.chi2);
    out["dof"] = r.dof;
    out["residuals"] = plan.problem.residuals;
    out["sigma_known"] = plan.problem.sigma_known;
    out["probability"] = finite_or_null(r.probability);
    out["error_factor"] = finite_or_null(r.error_factor);
    out["rms"] = finite_or_null(std::sqrt(r.chi2 / static_cast<double>(plan.problem.residuals)));
    out["objective"] = finite_or_null(fit.objective);
    out["loss"] = fit.loss == fitting::Loss::squares ? "squares"
                  : fit.loss == fitting::Loss::huber ? "huber"
                                                     : "cauchy";
    out["termination"] = to_string(fit.termination);
    out["reason"] = fit.reason;
    out["distance"] = finite_or_null(fit.distance);
    out["evaluations"] = fit.evaluations;
    out["algorithm"] = to_string(plan.method.algorithm);
    out["rank"] = r.rank;
    out["flat"] = ordered_json::array();
    for (const fitting::FlatDirection& f : r.flat)
        out["flat"].push_back({{"text", f.text},
                               {"singular_value", finite_or_null(f.singular_value)},
                               {"change", named(r, all_of(r), f.change)}});
    out["remarks"] = r.diagnostics;
    out["same_optimum"] = r.same_optimum;
    out["starts"] = ordered_json::array();
    for (const fitting::StartResult& s : fit.starts)
        out["starts"].push_back(start_json(r, s));
}

void add_data(ordered_json& out, const FitPlan& plan, const FitResults& results) {
    for (const char* list : {"profiles", "trajectories", "maps", "compare"})
        out[list] = ordered_json::array();
    for (std::size_t i = 0; i < results.profiles.size(); ++i)
        out["profiles"].push_back(profile_json(plan, results, i));
    for (std::size_t i = 0; i < results.tracks.size(); ++i)
        out["trajectories"].push_back(track_json(plan, results, i));
    for (std::size_t i = 0; i < results.maps.size(); ++i)
        out["maps"].push_back(map_json(plan, results, i));
    for (std::size_t i = 0; i < results.compare.size(); ++i)
        out["compare"].push_back(compare_json(plan.keys.compare[i], results, results.compare[i]));
}

} // namespace

std::string fit_json(const FitPlan& plan, const FitResults& results, const FitOrigin& origin) {
    ordered_json out;
    add_parameters(out, plan, results);
    add_quality(out, plan, results);
    out["likelihood"] = ordered_json::object();
    for (const auto& [name, l] : results.likelihood)
        out["likelihood"][name] = {{"value", numbers(l.value)},
                                   {"chi2", numbers(l.chi2)},
                                   {"low", finite_or_null(l.low)},
                                   {"high", finite_or_null(l.high)}};
    add_data(out, plan, results);
    out["systematics"] = systematics_json(plan, results);
    out["length_unit"] = plan.keys.length_unit;
    out["box"] = sides(plan.keys.box);
    out["core"] = plan.keys.core;
    out["heading"] = plan.keys.heading;
    out["independent_spacing"] = finite_or_null(plan.keys.independent_spacing);
    out["seed"] = plan.method.seed;
    out["provenance"] = {
        {"command", origin.command}, {"version", build_info().version}, {"git", build_info().git}};
    return out.dump(2) + "\n";
}

} // namespace rodwake::app
