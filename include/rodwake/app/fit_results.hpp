#pragma once
// What a fit found, put beside its data: everything fit.json and its tables hold.

#include "rodwake/app/fit.hpp"
#include "rodwake/fitting/misfit.hpp"
#include "rodwake/fitting/report.hpp"

#include <map>
#include <optional>

namespace rodwake::app {

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

struct FitMapResult {
    elastic::DisplacementMap model; ///< at every bin
    std::vector<bool> used;
    std::size_t bins = 0; ///< used ones
    double chi2 = 0.0;    ///< of the used ones, both components
};

/// What other fits say of the errors; lists of numbers are those of all parameters.
struct FitSystematics {
    struct Held {
        std::string name;
        double error = 0.0;         ///< of the constant
        std::vector<double> change; ///< of the parameters for one such error
    };
    struct MaskFit {
        fitting::MapMask mask;
        std::size_t residuals = 0;
        fitting::Report report;
    };
    struct LeftOut {
        std::size_t map = 0;
        std::vector<double> values;
    };
    std::vector<Held> held;
    std::vector<MaskFit> masks; ///< the first is that of the fit
    std::vector<LeftOut> runs;  ///< of the jackknife
    /// Empty: not asked for. `total`: the larger of the jackknife's error and the curvature's, with the other
    /// two.
    std::vector<double> held_error, mask_spread, jackknife, total;
    // Behind those of the parameters the lists of numbers have one of each derived quantity, to first order.
};

struct FitCompareResult {
    std::optional<fitting::Report> line; ///< the fit of one line that the values are from
    std::vector<double> values = {};     ///< of all parameters
    std::vector<double> point = {};      ///< beside maps: f_over_mu, eta and xi of a point force
    double chi2 = 0.0;                   ///< over the fitted profiles and maps
    std::vector<double> profile_chi2 = {};
    std::vector<std::optional<fitting::ScaleFactor>> scale_factor = {};
};

struct FitResults {
    fitting::Fit fit;
    fitting::Report report;
    std::map<std::string, fitting::ProfileLikelihood> likelihood;
    std::map<std::string, Estimate> derived; ///< alpha of a fit of xi, xi of one of alpha, both of drag_area
    std::map<std::string, std::map<std::string, double>> gradients; ///< of these, by the parameters
    std::vector<FitProfileResult> profiles;
    std::vector<FitTrackResult> tracks;
    std::vector<FitMapResult> maps;
    FitSystematics systematics;
    fitting::Misfit misfit;
    std::vector<FitCompareResult> compare;
};

/// Everything but likelihood and systematics, which take searches of their own.
FitResults fit_results(const FitPlan& plan, fitting::Fit fit);

/// Standard error of a parameter or a derived quantity with all its causes; of the curvature alone where no
/// others were asked for.
double whole_error(const FitResults& results, const std::string& name);

} // namespace rodwake::app
