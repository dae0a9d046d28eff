#include "fit_files.hpp"

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

ordered_json errors_json(const FitSystematics& s, std::size_t i, double value,
                         const ordered_json& curvature) {
    const auto part = [&](const std::vector<double>& errors) {
        return errors.empty() ? ordered_json(nullptr) : finite_or_null(errors[i]);
    };
    return {{"value", finite_or_null(value)}, {"curvature", curvature},         {"held", part(s.held_error)},
            {"masks", part(s.mask_spread)},   {"jackknife", part(s.jackknife)}, {"total", part(s.total)}};
}

ordered_json map_json(const FitPlan& plan, const FitResults& results, std::size_t i) {
    const FitMapData& map = plan.maps[i];
    return {{"name", map.name},
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
            {"chi2", finite_or_null(results.maps[i].chi2)}};
}

/// Null where the scene asks for none.
ordered_json systematics_json(const FitPlan& plan, const FitResults& results) {
    const FitSystematics& s = results.systematics;
    if (s.total.empty())
        return nullptr;
    ordered_json out = {{"errors", ordered_json::object()}};
    for (const std::size_t i : results.report.free) {
        const fitting::Estimate& e = results.report.estimates[i];
        out["errors"][e.name] = errors_json(s, i, e.value,
                                            has_error(results.report, e) ? finite_or_null(e.standard_error)
                                                                         : ordered_json(nullptr));
    }
    std::size_t place = results.report.estimates.size();
    for (const auto& [name, one] : results.derived)
        out["errors"][name] = errors_json(s, place++, one.value, finite_or_null(one.error));
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
        out["runs"].push_back(
            {{"without", plan.maps[one.map].label()}, {"parameters", of_free(results.report, one.values)}});
    return out;
}

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
    ordered_json values = named(results.report, all_of(results.report), r.values);
    if (!r.point.empty())
        values = {{"f_over_mu", r.point[0]}, {"eta", r.point[1]}, {"xi", r.point[2]}};
    ordered_json out = {
        {"name", keys.name}, {"values", values}, {"chi2", finite_or_null(r.chi2)}, {"profiles", profiles}};
    if (r.line)
        out["line"] = {{"profile", *keys.line},
                       {"parameters", estimates_json(*r.line)},
                       {"chi2", finite_or_null(r.line->chi2)},
                       {"dof", r.line->dof}};
    return out;
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
    out["misfit"] = misfit_json(results.misfit);
    out["length_unit"] = plan.keys.length_unit;
    out["box"] = sides(plan.keys.box);
    out["core"] = plan.keys.core;
    out["heading"] = plan.keys.heading;
    out["independent_spacing"] = finite_or_null(plan.keys.independent_spacing);
    out["seed"] = plan.method.seed;
    out["provenance"] = {
        {"command", origin.command}, {"version", build_info().version}, {"git", build_info().git}};
    return json_text(out, 2) + "\n";
}

void write_profile(const fs::path& folder, std::size_t i, const FitProfileData& data,
                   const FitProfileResult& r) {
    std::vector<FitProfileRow> rows;
    for (std::size_t k = 0; k < data.data.place.size(); ++k)
        rows.push_back({data.data.place[k], data.data.value[k], r.sigma[k], r.model[k], r.band[k],
                        r.residual[k], r.used[k] ? 1.0 : 0.0});
    store::write_atomically(folder / fmt::format("fit_profile_{}.csv", i), csv_of(rows));
}

void write_curve(const fs::path& folder, std::size_t i, const FitProfileResult& r) {
    std::vector<FitCurveRow> rows;
    for (std::size_t k = 0; k < r.curve[0].size(); ++k)
        rows.push_back({r.curve[0][k], r.curve[1][k], r.curve[2][k]});
    RecordTable table;
    table.add(rows);
    for (std::size_t k = 3; k < r.curve.size(); ++k) {
        std::vector<FitComparison> compared;
        for (const double value : r.curve[k])
            compared.push_back({value});
        table.add(compared, std::to_string(k - 3));
    }
    store::write_atomically(folder / fmt::format("fit_curve_{}.csv", i), table.csv());
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

void write_track(const fs::path& folder, std::size_t i, const FitTrackData& track, const FitTrackResult& r) {
    std::vector<FitTimeRow> times;
    for (const double t : track.data.times)
        times.push_back({t * track.time});
    RecordTable table;
    table.add(times);
    add_states<MeasuredPose>(table, track, track.data.states);
    add_states<FittedPose>(table, track, r.model);
    store::write_atomically(folder / fmt::format("fit_trajectory_{}.csv", i), table.csv());
}

/// All bins, row by row; what is not known is empty.
void write_map(const fs::path& folder, std::size_t i, const fitting::Map& map, const FitMapResult& r) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    const double enlarged = 1.0 / std::sqrt(map.independent);
    std::vector<FitMapRow> rows;
    for (std::size_t bin = 0; bin < map.bins(); ++bin) {
        const bool known = map.known[bin], sigma = known && !map.sigma_x.empty();
        rows.push_back({map.place_x(bin), map.place_y(bin), known ? map.Ux[bin] : unknown,
                        known ? map.Uy[bin] : unknown, sigma ? enlarged * map.sigma_x[bin] : unknown,
                        sigma ? enlarged * map.sigma_y[bin] : unknown, r.model.Ux[bin], r.model.Uy[bin],
                        known ? 1.0 : 0.0, r.used[bin] ? 1.0 : 0.0});
    }
    store::write_atomically(folder / fmt::format("fit_map_{}.csv", i), csv_of(rows));
}

} // namespace

void write_fit(const fs::path& folder, const FitPlan& plan, const FitResults& results,
               const FitOrigin& origin) {
    for (std::size_t i = 0; i < results.profiles.size(); ++i) {
        write_profile(folder, i, plan.profiles[i], results.profiles[i]);
        write_curve(folder, i, results.profiles[i]);
    }
    for (std::size_t i = 0; i < results.tracks.size(); ++i)
        write_track(folder, i, plan.tracks[i], results.tracks[i]);
    for (std::size_t i = 0; i < results.maps.size(); ++i)
        write_map(folder, i, plan.maps[i].data, results.maps[i]);
    store::write_atomically(folder / "fit.json", fit_json(plan, results, origin));
}

} // namespace rodwake::app
