#pragma once
// Parts of fit.json about the data: profiles, tracks, maps, comparisons, and the errors that they cause.

#include "fit_stage.hpp"
#include "run/record_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace rodwake::app {

using FitValues = Named<double>; ///< of parameters

/// make(0), make(1), ...
template<class Make>
auto listed(std::size_t count, const Make& make) {
    std::vector<decltype(make(count))> all;
    for (std::size_t i = 0; i < count; ++i)
        all.push_back(make(i));
    return all;
}

/// The standard error of an estimate; NaN: it is fixed or held by a bound.
inline double error_of(const fitting::Report& report, const fitting::ParameterEstimate& e) {
    return has_error(report, e) ? e.standard_error : std::nan("");
}

/// Values of all parameters, or of the free ones among them.
inline FitValues values_of_parameters(const fitting::Report& report, const std::vector<double>& values,
                                      bool free_only = false) {
    FitValues named;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!free_only || std::ranges::count(report.free, i) > 0)
            named.emplace_back(report.estimates[i].name, values[i]);
    return named;
}

struct FitExcess : fitting::ScaleFactor {
    static constexpr auto fields() {
        using R = FitExcess;
        return std::tuple{
            field("scale", &R::scale, {"1", "factor between data and model: data = scale * model"}),
            field("stderr", &R::standard_error, {"1", "its standard error"}),
            field("chi2", &R::chi2, {"1", "chi2 of the prediction itself (scale 1)"}),
            field("points", &R::points, {"1", "number of points behind the factor"})};
    }

    static OrNull<FitExcess> of(const std::optional<fitting::ScaleFactor>& factor) {
        return factor ? OrNull<FitExcess>(FitExcess{*factor}) : OrNull<FitExcess>();
    }
};

struct FitProfileEntry {
    std::size_t index;
    const FitProfileData& read;
    const scene::FitProfile& keys;
    const FitProfileResult& result;

    static constexpr auto fields() {
        using R = FitProfileEntry;
        return std::tuple{
            field("name", {"1", "of the profile"}, [](const R& r) { return r.read.name; }),
            field("medium", {"1", "of the model: isotropic"}, [](const R&) { return "isotropic"; }),
            field("file", {"1", "with the data"}, [](const R& r) { return r.read.file.string(); }),
            field("component", {"1", "Ux or Uy"}, [](const R& r) { return r.keys.component; }),
            field("along", {"1", "the axis of the line"}, [](const R& r) { return r.keys.along; }),
            field("at", {"{data}", "the other coordinate of the line"}, [](const R& r) { return r.keys.at; }),
            field("role", {"1", "fit or predict"},
                  [](const R& r) { return r.keys.role == scene::FitRole::fit ? "fit" : "predict"; }),
            field("points", {"1", "of the profile"}, [](const R& r) { return r.result.used.size(); }),
            field("used", {"1", "points outside the core"},
                  [](const R& r) { return std::ranges::count(r.result.used, true); }),
            field("independent", {"1", "independent values that a point is worth"},
                  [](const R& r) { return r.read.data.independent; }),
            field("data", {"1", "table of the points"},
                  [](const R& r) { return fmt::format("fit_profile_{}.csv", r.index); }),
            field("curve", {"1", "table of the model along the line"},
                  [](const R& r) { return fmt::format("fit_curve_{}.csv", r.index); }),
            field("chi2", {"1", "of the points outside the core; part of chi2 if role is fit"},
                  [](const R& r) { return r.result.chi2; }),
            field("excess", {"1", "of its data over the model (null: the model is 0 everywhere)"},
                  [](const R& r) { return FitExcess::of(r.result.scale_factor); })};
    }
};

struct FitTrackEntry {
    std::size_t index;
    const FitTrackData& read;
    const FitTrackResult& result;

    static constexpr auto fields() {
        using R = FitTrackEntry;
        return std::tuple{
            field("name", {"1", "of the tracks"}, [](const R& r) { return r.read.name; }),
            field("file", {"1", "with the data"}, [](const R& r) { return r.read.file.string(); }),
            field("rods", {"1", "number of rods"}, [](const R& r) { return r.read.rods; }),
            field("rows", {"1", "number of times"}, [](const R& r) { return r.read.data.times.size(); }),
            field("independent", {"1", "independent values that a row is worth"},
                  [](const R& r) { return r.read.data.independent; }),
            field("data", {"1", "table of the rods with their fit"},
                  [](const R& r) { return fmt::format("fit_trajectory_{}.csv", r.index); }),
            field("rms_position", {"{data}", "root mean square distance of positions from the model"},
                  [](const R& r) { return r.result.rms_position; }),
            field("rms_heading", {"rad", "the same of headings"},
                  [](const R& r) { return r.result.rms_heading; })};
    }
};

struct FitMaskEntry : fitting::MapMask {
    static constexpr auto fields() {
        using R = FitMaskEntry;
        return std::tuple{field("strip", {"{data}", "half width of the strip that is left out"},
                                [](const R& r) { return r.strip; }),
                          field("radius", {"{data}", "of the circle that is left out"},
                                [](const R& r) { return r.radius; }),
                          field("sector",
                                {"rad", "lower and upper angle from the heading, on both sides of the rod; "
                                        "bins between them are kept"},
                                [](const R& r) {
                                    return std::vector{r.from, r.to};
                                })};
    }
};

struct FitMapEntry {
    std::size_t index;
    const FitPlan& plan;
    const FitMapData& read;
    const FitMapResult& result;

    static constexpr auto fields() {
        using R = FitMapEntry;
        return std::tuple{
            field("name", {"1", "of the map"}, [](const R& r) { return r.read.name; }),
            field("medium", {"1", "of the model: isotropic or orthotropic"},
                  [](const R& r) {
                      return scene::fit_is_isotropic(r.plan.keys) ? "isotropic" : "orthotropic";
                  }),
            field("file", {"1", "with the data"}, [](const R& r) { return r.read.file.string(); }),
            field("data", {"1", "table of the bins with their fit"},
                  [](const R& r) { return fmt::format("fit_map_{}.csv", r.index); }),
            field("bins", {"1", "of the map"}, [](const R& r) { return r.read.data.bins(); }),
            field("used", {"1", "bins with data that the mask keeps"},
                  [](const R& r) { return r.result.bins; }),
            field("box", {"{data}", "sides of the periodic box along and across the heading"},
                  [](const R& r) {
                      return std::vector{r.read.data.lx, r.read.data.ly};
                  }),
            field("speed", {"1", "of the rod against the medium, as fit.maps.speed"},
                  [](const R& r) { return r.read.data.speed; }),
            field("independent", {"1", "independent values that a bin is worth"},
                  [](const R& r) { return r.read.data.independent; }),
            field("mirrored", {"1", "whether both sides of the rod were averaged"},
                  [](const R& r) { return r.read.mirrored; }),
            field("mask", {"1", "of the fit"}, [](const R& r) { return FitMaskEntry{r.plan.mask}; }),
            field("chi2", {"1", "part of the map in chi2"}, [](const R& r) { return r.result.chi2; })};
    }
};

struct FitEstimateEntry {
    double value, error;

    static constexpr auto fields() {
        using R = FitEstimateEntry;
        return std::tuple{field("value", &R::value, {"{unit}", "best value of a free parameter"}),
                          field("stderr", &R::error, {"{unit}", "its standard error"})};
    }

    static Named<FitEstimateEntry> of(const fitting::Report& report) {
        Named<FitEstimateEntry> named;
        for (const std::size_t i : report.free) {
            const fitting::ParameterEstimate& e = report.estimates[i];
            named.emplace_back(e.name, FitEstimateEntry{e.value, error_of(report, e)});
        }
        return named;
    }
};

struct FitComparedProfile {
    double chi2;
    OrNull<FitExcess> excess;

    static constexpr auto fields() {
        using R = FitComparedProfile;
        return std::tuple{field("chi2", &R::chi2, {"1", "part of a profile with these values"}),
                          field("excess", &R::excess, {"1", "of its data over the model with these values"})};
    }
};

struct FitLineEntry {
    long profile;
    const fitting::Report& report;

    static constexpr auto fields() {
        using R = FitLineEntry;
        return std::tuple{
            field("profile", &R::profile,
                  {"1", "number of the profile that the values were fitted to, from 0"}),
            field("parameters", {"1", "of this fit"},
                  [](const R& r) { return FitEstimateEntry::of(r.report); }),
            field("chi2", {"1", "of this fit"}, [](const R& r) { return r.report.chi2; }),
            field("dof", {"1", "degrees of freedom of this fit"}, [](const R& r) { return r.report.dof; })};
    }
};

struct FitCompareEntry {
    const FitPlan& plan;
    const FitResults& results;
    std::size_t index;

    const scene::FitCompare& keys() const { return plan.keys.compare[index]; }
    const FitCompareResult& result() const { return results.compare[index]; }

    static constexpr auto fields() {
        using R = FitCompareEntry;
        return std::tuple{
            field("name", {"1", "of the comparison"}, [](const R& r) { return r.keys().name; }),
            field(
                "values",
                {"1", "of the parameters, or f_over_mu, eta and xi of a point force in an isotropic medium"},
                [](const R& r) {
                    const std::vector<double>& point = r.result().point;
                    return point.empty()
                               ? values_of_parameters(r.results.report, r.result().values)
                               : FitValues{{"f_over_mu", point[0]}, {"eta", point[1]}, {"xi", point[2]}};
                }),
            field("chi2", {"1", "with these values"}, [](const R& r) { return r.result().chi2; }),
            field("profiles", {"1", "with these values"},
                  [](const R& r) {
                      std::vector<FitComparedProfile> all;
                      for (std::size_t k = 0; k < r.result().scale_factor.size(); ++k)
                          all.push_back(
                              {r.result().profile_chi2[k], FitExcess::of(r.result().scale_factor[k])});
                      return all;
                  }),
            field("line", {"1", "the fit of one line that the values are from (absent: none)"},
                  [](const R& r) {
                      return r.result().line ? std::optional(FitLineEntry{*r.keys().line, *r.result().line})
                                             : std::nullopt;
                  })};
    }
};

struct FitErrorEntry {
    double value, curvature, held, masks, jackknife, total;

    static constexpr auto fields() {
        using R = FitErrorEntry;
        return std::tuple{
            field("value", &R::value, {"{unit}", "best value"}),
            field("curvature", &R::curvature, {"{unit}", "standard error from the curvature (as stderr)"}),
            field("held", &R::held, {"{unit}", "error by the errors of constants that are held"}),
            field("masks", &R::masks, {"{unit}", "spread over the masks"}),
            field("jackknife", &R::jackknife, {"{unit}", "error by leaving out one map after the other"}),
            field("total", &R::total, {"{unit}", "the error to quote for maps"})};
    }
};

struct FitHeldEntry {
    std::string name;
    double error;
    FitValues change;

    static constexpr auto fields() {
        using R = FitHeldEntry;
        return std::tuple{
            field("name", &R::name, {"1", "of a constant that is held (fit.fixed_errors)"}),
            field("error", &R::error, {"{unit}", "its standard error, from fit.fixed_errors"}),
            field("change", &R::change,
                  {"1", "change of the free parameters if the constant changes by this error"})};
    }
};

struct FitMaskFitEntry : FitMaskEntry {
    std::size_t residuals;
    const fitting::Report& report;

    static constexpr auto fields() {
        using R = FitMaskFitEntry;
        return std::tuple_cat(
            FitMaskEntry::fields(),
            std::tuple{
                field("residuals", &R::residuals, {"1", "number of residuals with this mask"}),
                field("chi2", {"1", "of the fit with this mask"}, [](const R& r) { return r.report.chi2; }),
                field("dof", {"1", "degrees of freedom of this fit"},
                      [](const R& r) { return r.report.dof; }),
                field("parameters", {"1", "of this fit"},
                      [](const R& r) { return FitEstimateEntry::of(r.report); })});
    }
};

struct FitRunEntry {
    std::string without;
    FitValues parameters;

    static constexpr auto fields() {
        using R = FitRunEntry;
        return std::tuple{
            field("without", &R::without, {"1", "the map that was left out"}),
            field("parameters", &R::parameters, {"1", "free parameters, fitted to the other maps"})};
    }
};

/// Errors by their cause.
struct FitSystematicsEntry {
    Named<FitErrorEntry> errors;
    std::vector<FitHeldEntry> held;
    std::vector<FitMaskFitEntry> masks;
    std::vector<FitRunEntry> runs;

    static constexpr auto fields() {
        using R = FitSystematicsEntry;
        return std::tuple{
            field("errors", &R::errors, {"1", "of free parameters and derived quantities, by cause"}),
            field("held", &R::held, {"1", "by the errors of constants"}),
            field("masks", &R::masks, {"1", "fits with each mask"}),
            field("runs", &R::runs, {"1", "fits without one of the maps"})};
    }
};

} // namespace rodwake::app
