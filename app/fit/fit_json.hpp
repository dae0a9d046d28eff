#pragma once
// fit.json: parameters with errors, and how good the fit is. The order of the keys is that of the records.

#include "fit_data_json.hpp"
#include "rodwake/core/build_info.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace rodwake::app {

struct FitParameterEntry : fitting::ParameterEstimate {
    const fitting::Parameter& p;
    double error;
    std::string unit;

    static constexpr auto fields() {
        using R = FitParameterEntry;
        return std::tuple{
            field("value", {"{unit}", "best value"}, [](const R& r) { return r.value; }),
            field("stderr", &R::error,
                  {"{unit}", "standard error (null: fixed, at a bound, or not fixed by the data)"}),
            field("low", {"{unit}", "lower end of its 95 % interval"}, [](const R& r) { return r.low; }),
            field("high", {"{unit}", "upper end of its 95 % interval"}, [](const R& r) { return r.high; }),
            field("free", {"1", "whether it was fitted"}, [](const R& r) { return r.p.free(); }),
            field("fixed", {"1", "whether the scene fixes it"}, [](const R& r) { return r.p.fixed; }),
            field("tied_to", {"1", "the parameter that it follows (null: none)"},
                  [](const R& r) {
                      return r.p.tied_to.empty() ? OrNull<std::string>() : OrNull<std::string>(r.p.tied_to);
                  }),
            field("at_bound", {"1", "lower or upper, if it ended there (null: neither)"},
                  [](const R& r) {
                      return r.at_lower   ? OrNull<std::string>("lower")
                             : r.at_upper ? OrNull<std::string>("upper")
                                          : OrNull<std::string>();
                  }),
            field("unit", &R::unit, {"1", "of value, error and interval"}),
            field("start", {"{unit}", "where the search began"}, [](const R& r) { return r.p.start; }),
            field("bounds", {"{unit}", "lower and upper bound (null: none)"},
                  [](const R& r) {
                      return std::vector{r.p.lower, r.p.upper};
                  }),
            field("log", {"1", "whether its logarithm was searched"},
                  [](const R& r) { return r.p.transform == fitting::Transform::log; })};
    }
};

struct FitDerivedEntry {
    double value, error;
    std::string unit;

    static constexpr auto fields() {
        using R = FitDerivedEntry;
        return std::tuple{field("value", &R::value,
                                {"{unit}", "of a quantity that follows from the parameters, such as alpha"}),
                          field("stderr", &R::error, {"{unit}", "its standard error"}),
                          field("unit", &R::unit, {"1", "of value and error"})};
    }
};

struct FitFlatEntry : fitting::FlatDirection {
    const fitting::Report& report;

    static constexpr auto fields() {
        using R = FitFlatEntry;
        return std::tuple{field("text", &R::text,
                                {"1", "a combination of parameters that the data do not fix, or hardly "
                                      "(singular_value below 1e-3)"}),
                          field("singular_value", &R::singular_value,
                                {"1", "of this combination, relative to the largest"}),
                          field("change", {"1", "of the parameters along it, relative for log; largest = 1"},
                                [](const R& r) { return values_of_parameters(r.report, r.change); })};
    }
};

struct FitStartEntry : fitting::StartResult {
    const fitting::Report& report;

    /// A list with a value for each free parameter.
    static FitValues free_values(const fitting::Report& report, const std::vector<double>& values) {
        FitValues named;
        for (std::size_t k = 0; k < values.size(); ++k)
            named.emplace_back(report.estimates[report.free[k]].name, values[k]);
        return named;
    }

    static constexpr auto fields() {
        using R = FitStartEntry;
        return std::tuple{
            field("index", &R::index, {"1", "of the start, from 0"}),
            field("start", {"1", "values of the free parameters there"},
                  [](const R& r) { return free_values(r.report, r.start); }),
            field("end", {"1", "values of the free parameters where the search ended"},
                  [](const R& r) { return free_values(r.report, r.end); }),
            field("objective", &R::objective, {"1", "where the search ended (null: no finite residuals)"}),
            field("termination", &R::termination, {"1", "how the search ended"}),
            field("evaluations", &R::evaluations, {"1", "of the model in this search"})};
    }
};

struct FitLikelihoodEntry : fitting::ProfileLikelihood {
    static constexpr auto fields() {
        using R = FitLikelihoodEntry;
        return std::tuple{
            field("value", {"{unit}", "values of the parameter, in parameters.<k>.unit"},
                  [](const R& r) { return r.value; }),
            field("chi2", &R::chi2,
                  {"1", "smallest chi2 (by fit.loss) over the other parameters, at each value"}),
            field("low",
                  {"{unit}", "lower end of the 95 % interval by likelihood (null: unbounded on this side)"},
                  [](const R& r) { return r.low.value_or(std::nan("")); }),
            field("high",
                  {"{unit}", "upper end of the 95 % interval by likelihood (null: unbounded on this side)"},
                  [](const R& r) { return r.high.value_or(std::nan("")); })};
    }
};

struct MisfitTestEntry : fitting::MisfitTest {
    static constexpr auto fields() {
        using R = MisfitTestEntry;
        return std::tuple{
            field("value", &R::value, {"1", "of the test"}),
            field("expected", &R::expected, {"1", "value if the model is right"}),
            field("probability", &R::probability, {"1", "of so large a value if the model is right"}),
            field("text", &R::text, {"1", "the result in words"})};
    }
};

struct MisfitRegionEntry : fitting::MisfitRegion {
    static constexpr auto fields() {
        using R = MisfitRegionEntry;
        return std::tuple{
            field("name", &R::name, {"1", "of a part of the data"}),
            field("chi2", &R::chi2, {"1", "part of the region in chi2"}),
            field("expected", &R::expected, {"1", "the same if the model is right"}),
            field("probability", &R::probability, {"1", "of so large a part if the model is right"})};
    }
};

/// Member `misfit` of fit.json and of models.json.
struct MisfitEntry {
    const fitting::Misfit& misfit;

    static constexpr auto fields() {
        using R = MisfitEntry;
        return std::tuple{
            field("probability",
                  {"1", "of a misfit like this if the model is right (null: no degree of freedom is left)"},
                  [](const R& r) { return r.misfit.probability.value_or(std::nan("")); }),
            field("describes", {"1", "whether the model describes the data (null: unknown)"},
                  [](const R& r) {
                      return r.misfit.probability ? OrNull<bool>(r.misfit.describes()) : OrNull<bool>();
                  }),
            field("worst", {"1", "the worst test in words"}, [](const R& r) { return r.misfit.worst; }),
            field("tests", {"1", "by name"},
                  [](const R& r) {
                      Named<MisfitTestEntry> named;
                      for (const fitting::MisfitTest& test : r.misfit.tests)
                          named.emplace_back(test.name, MisfitTestEntry{test});
                      return named;
                  }),
            field("regions", {"1", "parts of the data"}, [](const R& r) {
                return std::vector<MisfitRegionEntry>(r.misfit.regions.begin(), r.misfit.regions.end());
            })};
    }
};

/// Who wrote a file of the fit.
struct FitProvenance {
    std::string command;

    static constexpr auto fields() {
        using R = FitProvenance;
        return std::tuple{
            field("command", &R::command, {"1", "that wrote the file"}),
            field("version", {"1", "of the program"}, [](const R&) { return build_info().version; }),
            field("git", {"1", "commit of the program"}, [](const R&) { return build_info().git; })};
    }
};

struct FitJson {
    const FitPlan& plan;
    const FitResults& results;
    const std::string& command;

    const fitting::Report& report() const { return results.report; }
    Named<FitParameterEntry> parameters() const;
    Named<FitDerivedEntry> derived() const;
    std::vector<std::vector<double>> correlation() const;
    OrNull<FitSystematicsEntry> systematics() const;

    static constexpr auto fields() {
        using R = FitJson;
        return std::tuple{
            field("parameters", {"1", "of the model"}, [](const R& r) { return r.parameters(); }),
            field("derived", {"1", "quantities that follow from them"},
                  [](const R& r) { return r.derived(); }),
            field("free", {"1", "fitted parameters, in the order of correlation"},
                  [](const R& r) {
                      std::vector<std::string> names;
                      for (const std::size_t i : r.report().free)
                          names.push_back(r.report().estimates[i].name);
                      return names;
                  }),
            field("correlation", {"1", "correlation matrix (null: one of the two has no error)"},
                  [](const R& r) { return r.correlation(); }),
            field("chi2", {"1", "sum of the squared residuals"}, [](const R& r) { return r.report().chi2; }),
            field("dof", {"1", "independent values less free parameters"},
                  [](const R& r) { return r.report().dof; }),
            field("residuals", {"1", "number of residuals"},
                  [](const R& r) { return fitting::data_count(r.plan.problem); }),
            field("sigma_known",
                  {"1", "whether the data have standard errors; otherwise errors come from the scatter"},
                  [](const R& r) { return r.plan.problem.sigma_known; }),
            field("probability", {"1", "of so large a chi2 if model and sigmas are right"},
                  [](const R& r) { return r.report().probability; }),
            field("error_factor", {"1", "factor by which errors were multiplied (null: no error is known)"},
                  [](const R& r) { return r.report().error_factor; }),
            field("rms", {"1", "root mean square of the residuals"},
                  [](const R& r) {
                      return std::sqrt(r.report().chi2 /
                                       static_cast<double>(fitting::data_count(r.plan.problem)));
                  }),
            field("objective", {"1", "the minimum that was searched for, by fit.loss"},
                  [](const R& r) { return r.results.fit.objective; }),
            field("loss", {"1", "squares, huber or cauchy"},
                  [](const R& r) {
                      const fitting::Loss loss = r.results.fit.loss;
                      return loss == fitting::Loss::squares ? "squares"
                             : loss == fitting::Loss::huber ? "huber"
                                                            : "cauchy";
                  }),
            field("termination", {"1", "how the best search ended"},
                  [](const R& r) { return to_string(r.results.fit.termination); }),
            field("reason", {"1", "why it ended so"}, [](const R& r) { return r.results.fit.reason; }),
            field("distance", {"1", "of the end from the minimum, in standard errors"},
                  [](const R& r) { return r.results.fit.distance; }),
            field("evaluations", {"1", "of the model, in all searches"},
                  [](const R& r) { return r.results.fit.evaluations; }),
            field("algorithm", {"1", "of the search"},
                  [](const R& r) { return to_string(r.plan.method.algorithm); }),
            field("rank", {"1", "number of combinations of parameters that the data fix"},
                  [](const R& r) { return r.report().rank; }),
            field("flat", {"1", "combinations that the data do not fix, or hardly"},
                  [](const R& r) {
                      return listed(r.report().flat.size(), [&](std::size_t i) {
                          return FitFlatEntry{r.report().flat[i], r.report()};
                      });
                  }),
            field("remarks", {"1", "to know before a number is quoted"},
                  [](const R& r) { return r.report().diagnostics; }),
            field("same_optimum", {"1", "starts that ended at the best optimum"},
                  [](const R& r) { return r.report().same_optimum; }),
            field("starts", {"1", "of the search"},
                  [](const R& r) {
                      return listed(r.results.fit.starts.size(), [&](std::size_t i) {
                          return FitStartEntry{r.results.fit.starts[i], r.report()};
                      });
                  }),
            field("likelihood", {"1", "of the parameters of fit.likelihood"},
                  [](const R& r) {
                      Named<FitLikelihoodEntry> named;
                      for (const auto& [name, profile] : r.results.likelihood)
                          named.emplace_back(name, FitLikelihoodEntry{profile});
                      return named;
                  }),
            field("profiles", {"1", "of the data"},
                  [](const R& r) {
                      return listed(r.results.profiles.size(), [&](std::size_t i) {
                          return FitProfileEntry{i, r.plan.profiles[i], r.plan.keys.profiles[i],
                                                 r.results.profiles[i]};
                      });
                  }),
            field("trajectories", {"1", "of the data"},
                  [](const R& r) {
                      return listed(r.results.tracks.size(), [&](std::size_t i) {
                          return FitTrackEntry{i, r.plan.tracks[i], r.results.tracks[i]};
                      });
                  }),
            field("maps", {"1", "of the data"},
                  [](const R& r) {
                      return listed(r.results.maps.size(), [&](std::size_t i) {
                          return FitMapEntry{i, r.plan, r.plan.maps[i], r.results.maps[i]};
                      });
                  }),
            field("compare", {"1", "other values beside the fit"},
                  [](const R& r) {
                      return listed(r.results.compare.size(), [&](std::size_t i) {
                          return FitCompareEntry{r.plan, r.results, i};
                      });
                  }),
            field("systematics", {"1", "errors beyond the curvature (null: not requested)"},
                  [](const R& r) { return r.systematics(); }),
            field("misfit", {"1", "whether the model describes the data"},
                  [](const R& r) { return MisfitEntry{r.results.misfit}; }),
            field("length_unit", {"1", "unit of the data"},
                  [](const R& r) { return r.plan.keys.length_unit; }),
            field("box", {"{data}", "side of the periodic box of the profiles, or both (null: the plane)"},
                  [](const R& r) -> std::variant<std::monostate, double, std::vector<double>> {
                      const std::optional<PeriodicBox>& box = r.plan.keys.box;
                      if (!box)
                          return {};
                      if (box->square())
                          return box->x;
                      return std::vector{box->x, box->y};
                  }),
            field("core", {"{data}", "fit.core"}, [](const R& r) { return r.plan.keys.core; }),
            field("heading", {"rad", "fit.heading"}, [](const R& r) { return r.plan.keys.heading; }),
            field("independent_spacing", {"{data}", "fit.independent_spacing (null: all are independent)"},
                  [](const R& r) { return r.plan.keys.independent_spacing.value_or(std::nan("")); }),
            field("seed", {"1", "of the random starts"}, [](const R& r) { return r.plan.method.seed; }),
            field("provenance", {"1", "of the file"}, [](const R& r) { return FitProvenance{r.command}; })};
    }
};

} // namespace rodwake::app
