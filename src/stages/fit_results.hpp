#pragma once
// What a fit found, put beside its data: everything fit.json and its tables hold.

#include "fit_data.hpp"
#include "rodwake/fitting/report.hpp"

#include <map>
#include <optional>

namespace rodwake::stages {

struct FitProfileResult {
    std::vector<double> model, band, residual, sigma; ///< at every point; sigma as used, 0: unknown
    std::vector<bool> used;                           ///< outside the core
    double chi2 = 0.0;                                ///< of the used ones
    std::optional<fitting::ScaleFactor> scale_factor; ///< absent where the model is 0 everywhere
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
    std::vector<std::optional<fitting::ScaleFactor>> scale_factor;
};

struct FitResults {
    fitting::Fit fit;
    fitting::Report report;
    std::map<std::string, fitting::ProfileLikelihood> likelihood;
    std::map<std::string, Estimate> derived; ///< alpha of a fit of xi, xi of one of alpha
    std::vector<FitProfileResult> profiles;
    std::vector<FitTrackResult> tracks;
    std::vector<FitCompareResult> compare;
};

/// Everything but the likelihood, which takes searches of its own.
FitResults fit_results(const assembly::FitPlan& plan, fitting::Fit fit);

} // namespace rodwake::stages
