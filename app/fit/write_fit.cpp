#include "fit_stage.hpp"

#include "fit_records.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

/// Values of all parameters by name.
ordered_json by_name(const fitting::Report& report, const std::vector<double>& values) {
    ordered_json out = ordered_json::object();
    for (std::size_t i = 0; i < values.size(); ++i)
        out[report.estimates[i].name] = finite_or_null(values[i]);
    return out;
}

/// The free ones among values of all parameters.
ordered_json free_of_all(const fitting::Report& report, const std::vector<double>& values) {
    ordered_json out = ordered_json::object();
    for (const std::size_t i : report.free)
        out[report.estimates[i].name] = finite_or_null(values[i]);
    return out;
}

/// A list with a value for each free parameter.
ordered_json free_by_name(const fitting::Report& report, const std::vector<double>& values) {
    ordered_json out = ordered_json::object();
    for (std::size_t k = 0; k < values.size(); ++k)
        out[report.estimates[report.free[k]].name] = finite_or_null(values[k]);
    return out;
}

/// A parameter that is fixed or held by a bound has no error.
ordered_json error_json(const fitting::Report& report, const fitting::ParameterEstimate& e) {
    return has_error(report, e) ? finite_or_null(e.standard_error) : ordered_json(nullptr);
}

ordered_json estimates_json(const fitting::Report& report) {
    ordered_json out = ordered_json::object();
    for (const std::size_t i : report.free) {
        const fitting::ParameterEstimate& e = report.estimates[i];
        out[e.name] = {{"value", finite_or_null(e.value)}, {"stderr", error_json(report, e)}};
    }
    return out;
}

ordered_json mask_json(const fitting::MapMask& mask) {
    return {{"strip", mask.strip}, {"radius", mask.radius}, {"sector", {mask.from, mask.to}}};
}

ordered_json scale_factor_json(const std::optional<fitting::ScaleFactor>& e) {
    if (!e)
        return nullptr;
    return {{"scale", finite_or_null(e->scale)},
            {"stderr", finite_or_null(e->standard_error)},
            {"chi2", finite_or_null(e->chi2)},
            {"points", e->points}};
}

/// Parameters and derived quantities with their errors, and the correlations of the free ones.
void add_parameters(ordered_json& out, const FitPlan& plan, const FitResults& results) {
    const fitting::Report& report = results.report;
    const ordered_json none = nullptr;
    out["parameters"] = ordered_json::object();
    for (std::size_t i = 0; i < report.estimates.size(); ++i) {
        const fitting::ParameterEstimate& e = report.estimates[i];
        const fitting::Parameter& p = plan.problem.parameters[i];
        out["parameters"][e.name] = {{"value", finite_or_null(e.value)},
                                     {"stderr", error_json(report, e)},
                                     {"low", finite_or_null(e.low)},
                                     {"high", finite_or_null(e.high)},
                                     {"free", p.free()},
                                     {"fixed", p.fixed},
                                     {"tied_to", p.tied_to.empty() ? none : ordered_json(p.tied_to)},
                                     {"at_bound", e.at_lower   ? ordered_json("lower")
                                                  : e.at_upper ? ordered_json("upper")
                                                               : none},
                                     {"unit", fit_unit(plan.keys, p.name)},
                                     {"start", p.start},
                                     {"bounds", {finite_or_null(p.lower), finite_or_null(p.upper)}},
                                     {"log", p.transform == fitting::Transform::log}};
    }
    out["derived"] = ordered_json::object();
    for (const auto& [name, d] : results.derived)
        out["derived"][name] = {{"value", finite_or_null(d.value)},
                                {"stderr", finite_or_null(d.error)},
                                {"unit", fit_unit(plan.keys, name)}};
    out["free"] = ordered_json::array();
    for (const std::size_t i : report.free)
        out["free"].push_back(report.estimates[i].name);

    // A correlation is unknown if one of the two has no error, or an infinite one.
    const auto known = [&](Eigen::Index k) {
        const fitting::ParameterEstimate& e = report.estimates[report.free[static_cast<std::size_t>(k)]];
        return has_error(report, e) && std::isfinite(e.standard_error);
    };
    const Eigen::MatrixXd& m = report.correlation;
    out["correlation"] = ordered_json::array();
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
        ordered_json row = ordered_json::array();
        for (Eigen::Index j = 0; j < m.cols(); ++j)
            row.push_back(i == j || (known(i) && known(j)) ? finite_or_null(m(i, j)) : none);
        out["correlation"].push_back(row);
    }
}

/// How good the fit is and how it was found.
void add_quality(ordered_json& out, const FitPlan& plan, const FitResults& results) {
    const fitting::Report& r = results.report;
    const fitting::Fit& fit = results.fit;
    out["chi2"] = finite_or_null(r.chi2);
    out["dof"] = r.dof;
    out["residuals"] = fitting::data_count(plan.problem);
    out["sigma_known"] = plan.problem.sigma_known;
    out["probability"] = finite_or_null(r.probability);
    out["error_factor"] = finite_or_null(r.error_factor);
    out["rms"] = finite_or_null(std::sqrt(r.chi2 / static_cast<double>(fitting::data_count(plan.problem))));
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
                               {"change", by_name(r, f.change)}});
    out["remarks"] = r.diagnostics;
    out["same_optimum"] = r.same_optimum;
    out["starts"] = ordered_json::array();
    for (const fitting::StartResult& s : fit.starts)
        out["starts"].push_back({{"index", s.index},
                                 {"start", free_by_name(r, s.start)},
                                 {"end", free_by_name(r, s.end)},
                                 {"objective", finite_or_null(s.objective)},
                                 {"termination", s.termination},
                                 {"evaluations", s.evaluations}});
    const auto numbers = [](const std::vector<double>& values) {
        ordered_json list = ordered_json::array();
        for (const double value : values)
            list.push_back(finite_or_null(value));
        return list;
    };
    out["likelihood"] = ordered_json::object();
    for (const auto& [name, l] : results.likelihood)
        out["likelihood"][name] = {{"value", numbers(l.value)},
                                   {"chi2", numbers(l.chi2)},
                                   {"low", finite_or_null(l.low)},
                                   {"high", finite_or_null(l.high)}};
}

/// Each profile, trajectory and map with its part of the misfit, and the comparisons.
void add_data(ordered_json& out, const FitPlan& plan, const FitResults& results) {
    for (const char* list : {"profiles", "trajectories", "maps", "compare"})
        out[list] = ordered_json::array();
    for (std::size_t i = 0; i < results.profiles.size(); ++i) {
        const scene::FitProfile& keys = plan.keys.profiles[i];
        const FitProfileResult& r = results.profiles[i];
        out["profiles"].push_back({{"name", plan.profiles[i].name},
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
                                   {"excess", scale_factor_json(r.scale_factor)}});
    }
    for (std::size_t i = 0; i < results.tracks.size(); ++i)
        out["trajectories"].push_back({{"name", plan.tracks[i].name},
                                       {"file", plan.tracks[i].file.string()},
                                       {"rods", plan.tracks[i].rods},
                                       {"rows", plan.tracks[i].data.times.size()},
                                       {"independent", plan.tracks[i].data.independent},
                                       {"data", fmt::format("fit_trajectory_{}.csv", i)},
                                       {"rms_position", finite_or_null(results.tracks[i].rms_position)},
                                       {"rms_heading", finite_or_null(results.tracks[i].rms_heading)}});
    for (std::size_t i = 0; i < results.maps.size(); ++i) {
        const FitMapData& map = plan.maps[i];
        out["maps"].push_back({{"name", map.name},
                               {"medium", scene::fit_is_isotropic(plan.keys) ? "isotropic" : "orthotropic"},
                               {"file", map.file.string()},
                               {"data", fmt::format("fit_map_{}.csv", i)},
                               {"bins", map.data.bins()},
                               {"used", results.maps[i].bins},
                               {"box", {map.data.lx, map.data.ly}},
                               {"speed", map.data.speed},
                               {"independent", map.data.independent},
                               {"mirrored", map.mirrored},
                               {"mask", mask_json(plan.mask)},
                               {"chi2", finite_or_null(results.maps[i].chi2)}});
    }
    for (std::size_t i = 0; i < results.compare.size(); ++i) {
        const FitCompareResult& r = results.compare[i];
        ordered_json profiles = ordered_json::array();
        for (std::size_t k = 0; k < r.scale_factor.size(); ++k)
            profiles.push_back({{"chi2", finite_or_null(r.profile_chi2[k])},
                                {"excess", scale_factor_json(r.scale_factor[k])}});
        ordered_json values = by_name(results.report, r.values);
        if (!r.point.empty())
            values = {{"f_over_mu", r.point[0]}, {"eta", r.point[1]}, {"xi", r.point[2]}};
        ordered_json comparison = {{"name", plan.keys.compare[i].name},
                                   {"values", values},
                                   {"chi2", finite_or_null(r.chi2)},
                                   {"profiles", profiles}};
        if (r.line)
            comparison["line"] = {{"profile", *plan.keys.compare[i].line},
                                  {"parameters", estimates_json(*r.line)},
                                  {"chi2", finite_or_null(r.line->chi2)},
                                  {"dof", r.line->dof}};
        out["compare"].push_back(comparison);
    }
}

/// Errors by their cause. Null if the scene requests none.
ordered_json systematics_json(const FitPlan& plan, const FitResults& results) {
    const FitSystematics& s = results.systematics;
    if (s.total.empty())
        return nullptr;
    const fitting::Report& report = results.report;
    const auto errors = [&](std::size_t i, double value, const ordered_json& curvature) -> ordered_json {
        const auto part = [&](const std::vector<double>& list) {
            return list.empty() ? ordered_json(nullptr) : finite_or_null(list[i]);
        };
        return {{"value", finite_or_null(value)}, {"curvature", curvature},
                {"held", part(s.held_error)},     {"masks", part(s.mask_spread)},
                {"jackknife", part(s.jackknife)}, {"total", part(s.total)}};
    };
    ordered_json out = {{"errors", ordered_json::object()}};
    for (const std::size_t i : report.free)
        out["errors"][report.estimates[i].name] =
            errors(i, report.estimates[i].value, error_json(report, report.estimates[i]));
    std::size_t index = report.estimates.size();
    for (const auto& [name, derived] : results.derived)
        out["errors"][name] = errors(index++, derived.value, finite_or_null(derived.error));
    for (const char* list : {"held", "masks", "runs"})
        out[list] = ordered_json::array();
    for (const auto& held : s.held)
        out["held"].push_back(
            {{"name", held.name}, {"error", held.error}, {"change", free_of_all(report, held.change)}});
    for (const auto& choice : s.masks) {
        ordered_json mask = mask_json(choice.mask);
        mask.update({{"residuals", choice.residuals},
                     {"chi2", finite_or_null(choice.report.chi2)},
                     {"dof", choice.report.dof},
                     {"parameters", estimates_json(choice.report)}});
        out["masks"].push_back(mask);
    }
    for (const auto& run : s.runs)
        out["runs"].push_back(
            {{"without", plan.maps[run.map].label()}, {"parameters", free_of_all(report, run.values)}});
    return out;
}

/// Poses of each rod from reduced states, in the file's unit.
template<class Pose>
void add_states(RecordTable& table, const FitTrackData& track,
                const std::vector<std::vector<double>>& states) {
    for (std::size_t rod = 0; rod < track.rods; ++rod) {
        std::vector<Pose> poses;
        poses.reserve(states.size());
        for (const auto& state : states)
            poses.push_back(
                {state[3 * rod] * track.length, state[3 * rod + 1] * track.length, state[3 * rod + 2]});
        table.add(poses, std::to_string(rod));
    }
}

} // namespace

void write_fit(const fs::path& folder, const FitPlan& plan, const FitResults& results,
               const std::string& command) {
    for (std::size_t i = 0; i < results.profiles.size(); ++i) {
        // The points of a profile, and the curve of the model with those of the comparisons.
        const fitting::Profile& data = plan.profiles[i].data;
        const FitProfileResult& r = results.profiles[i];
        std::vector<FitProfileRow> rows;
        for (std::size_t k = 0; k < data.place.size(); ++k)
            rows.push_back({data.place[k], data.value[k], r.sigma[k], r.model[k], r.band[k], r.residual[k],
                            r.used[k] ? 1.0 : 0.0});
        store::write_atomically(folder / fmt::format("fit_profile_{}.csv", i), csv_of(rows));
        std::vector<FitCurveRow> curve;
        for (std::size_t k = 0; k < r.curve[0].size(); ++k)
            curve.push_back({r.curve[0][k], r.curve[1][k], r.curve[2][k]});
        RecordTable table;
        table.add(curve);
        for (std::size_t k = 3; k < r.curve.size(); ++k) {
            std::vector<FitComparison> compared;
            for (const double value : r.curve[k])
                compared.push_back({value});
            table.add(compared, std::to_string(k - 3));
        }
        store::write_atomically(folder / fmt::format("fit_curve_{}.csv", i), table.csv());
    }
    for (std::size_t i = 0; i < results.tracks.size(); ++i) {
        std::vector<FitTimeRow> times;
        for (const double t : plan.tracks[i].data.times)
            times.push_back({t * plan.tracks[i].time});
        RecordTable table;
        table.add(times);
        add_states<MeasuredPose>(table, plan.tracks[i], plan.tracks[i].data.states);
        add_states<FittedPose>(table, plan.tracks[i], results.tracks[i].model);
        store::write_atomically(folder / fmt::format("fit_trajectory_{}.csv", i), table.csv());
    }
    for (std::size_t i = 0; i < results.maps.size(); ++i) {
        // All bins are written row by row; what is not known is empty.
        const fitting::Map& map = plan.maps[i].data;
        constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
        const double enlarged = 1.0 / std::sqrt(map.independent);
        std::vector<FitMapRow> rows;
        for (std::size_t bin = 0; bin < map.bins(); ++bin) {
            const bool known = map.known[bin], sigma = known && !map.sigma_x.empty();
            rows.push_back({map.place_x(bin), map.place_y(bin), known ? map.Ux[bin] : unknown,
                            known ? map.Uy[bin] : unknown, sigma ? enlarged * map.sigma_x[bin] : unknown,
                            sigma ? enlarged * map.sigma_y[bin] : unknown, results.maps[i].model.Ux[bin],
                            results.maps[i].model.Uy[bin], known ? 1.0 : 0.0,
                            results.maps[i].used[bin] ? 1.0 : 0.0});
        }
        store::write_atomically(folder / fmt::format("fit_map_{}.csv", i), csv_of(rows));
    }
    ordered_json out;
    add_parameters(out, plan, results);
    add_quality(out, plan, results);
    add_data(out, plan, results);
    out["systematics"] = systematics_json(plan, results);
    out["misfit"] = misfit_json(results.misfit);
    out["length_unit"] = plan.keys.length_unit;
    const std::optional<PeriodicBox>& box = plan.keys.box;
    out["box"] = !box            ? ordered_json(nullptr)
                 : box->square() ? ordered_json(box->x)
                                 : ordered_json{box->x, box->y};
    out["core"] = plan.keys.core;
    out["heading"] = plan.keys.heading;
    out["independent_spacing"] = finite_or_null(plan.keys.independent_spacing);
    out["seed"] = plan.method.seed;
    out["provenance"] = {{"command", command}, {"version", build_info().version}, {"git", build_info().git}};
    store::write_atomically(folder / "fit.json", json_text(out, 2) + "\n");
}

} // namespace rodwake::app
