#pragma once
// What a fit found, put beside its data: everything fit.json and its tables hold.

#include "fit_plan.hpp"
#include "rodwake/fitting/report.hpp"

#include <cmath>
#include <map>
#include <optional>

namespace rodwake::cli {

/// Value and standard error of what follows from the parameters. Infinite: not fixed by the data; absent: it
/// follows from fixed values alone, or from one that is held by a bound.
struct FitDerived {
    double value = 0.0;
    std::optional<double> error;

    bool not_fixed() const { return error && !std::isfinite(*error); }
};

struct FitProfileResult {
    std::vector<double> model, band, residual, sigma; ///< at every point; sigma as used, 0: unknown
    std::vector<bool> used;                           ///< outside the core
    double chi2 = 0.0;                                ///< of the used ones
    std::optional<fitting::Excess> excess;            ///< absent where the model is 0 everywhere
    /// places, model, band, then each comparison; places at the singularity are left out
    std::vector<std::vector<double>> curve;
};

struct FitTrackResult {
    std::vector<std::vector<double>> model;       ///< states at the data's times, reduced
    double rms_position = 0.0, rms_heading = 0.0; ///< file's unit; rad
};

struct FitCompareResult {
    std::vector<double> values; ///< of all parameters
    double chi2 = 0.0;          ///< over the fitted profiles
    std::vector<double> profile_chi2;
    std::vector<std::optional<fitting::Excess>> excess;
};

struct FitResults {
    fitting::Fit fit;
    fitting::Report report;
    std::map<std::string, fitting::ProfileLikelihood> likelihood;
    std::map<std::string, FitDerived> derived; ///< alpha of a fit of xi, xi of one of alpha
    std::vector<FitProfileResult> profiles;
    std::vector<FitTrackResult> tracks;
    std::vector<FitCompareResult> compare;
};

/// Everything but the likelihood, which takes searches of its own.
FitResults fit_results(const FitPlan& plan, fitting::Fit fit);

/// A function of the parameters with its gradient, and the error that follows.
FitDerived derived(const fitting::Report& report, double value,
                   const std::map<std::string, double>& gradient);

/// Whether the estimate, or the one it is tied to, is held by a bound.
bool at_bound(const fitting::Report& report, const fitting::Estimate& estimate);
/// Whether it has a standard error, if an infinite one: neither fixed nor held by a bound.
bool has_error(const fitting::Report& report, const fitting::Estimate& estimate);

/// Value of a parameter, if the fit has it.
std::optional<double> fitted_value(const fitting::Report& report, const std::string& name);

} // namespace rodwake::cli
