#pragma once
// What the tables of a fit hold. Lengths, times and displacements are in the unit of the data, which fit.json
// names.

#include "rodwake/core/record.hpp"

#include <cmath>

namespace rodwake::app {

/// fit_profile_<i>.csv
struct FitProfileRow {
    double x, value, sigma, model, band, residual, used;

    static constexpr auto fields() {
        using R = FitProfileRow;
        return std::tuple{
            field("x", &R::x, {"{data}", "position along the line"}),
            field("value", &R::value, {"{data}", "measured displacement"}),
            field("sigma", &R::sigma, {"{data}", "standard error as used (0: unknown)"}),
            field("model", &R::model, {"{data}", "fitted displacement"}),
            field("band", &R::band, {"{data}", "standard error of the model (empty: not fixed by the data)"}),
            field("residual", &R::residual, {"1", "(value - model)/sigma"}),
            field("used", &R::used, {"1", "1: fitted, 0: within the core"})};
    }
};

/// fit_curve_<i>.csv, and a column for each comparison
struct FitCurveRow {
    double x, model, band;

    static constexpr auto fields() {
        using R = FitCurveRow;
        return std::tuple{field("x", &R::x, {"{data}", "position along the line"}),
                          field("model", &R::model, {"{data}", "fitted displacement"}),
                          field("band", &R::band, {"{data}", "standard error of the model"})};
    }
};

struct FitComparison {
    double displacement;

    static constexpr auto fields() {
        return std::tuple{
            field("compare_", &FitComparison::displacement, {"{data}", "displacement of the comparison"})};
    }
};

/// fit_trajectory_<i>.csv: the time, the measured poses of each rod, the fitted ones
struct FitTimeRow {
    double t;

    static constexpr auto fields() { return std::tuple{field("t", &FitTimeRow::t, {"{data}", "time"})}; }
};

struct MeasuredPose {
    double x, y, theta;

    static constexpr auto fields() {
        using R = MeasuredPose;
        return std::tuple{field("x", &R::x, {"{data}", "measured position of the rod"}),
                          field("y", &R::y, {"{data}", "measured position of the rod"}),
                          field("theta", &R::theta, {"rad", "measured heading of the rod"})};
    }
};

struct FittedPose {
    double x, y, theta;

    static constexpr auto fields() {
        using R = FittedPose;
        return std::tuple{field("model_x", &R::x, {"{data}", "fitted position of the rod"}),
                          field("model_y", &R::y, {"{data}", "fitted position of the rod"}),
                          field("model_theta", &R::theta, {"rad", "fitted heading of the rod"})};
    }
};

/// posterior_curve_<i>.csv: what the samples predict along a profile's line
struct PredictedRow {
    double x, median, low, high, noise_low, noise_high;

    static constexpr auto fields() {
        using R = PredictedRow;
        return std::tuple{
            field("x", &R::x, {"{data}", "position along the line"}),
            field("median", &R::median, {"{data}", "displacement: median of the posterior"}),
            field("low", &R::low, {"{data}", "displacement: 2.5 % of the posterior"}),
            field("high", &R::high, {"{data}", "displacement: 97.5 % of the posterior"}),
            field("noise_low", &R::noise_low, {"{data}", "a datum there: 2.5 % (empty: sigma unknown)"}),
            field("noise_high", &R::noise_high, {"{data}", "a datum there: 97.5 % (empty: sigma unknown)"})};
    }
};

/// posterior_trajectory_<i>.csv: a row a time and a coordinate of a rod
struct PredictedPoseRow {
    double t, rod, coordinate, data, median, low, high, noise_low, noise_high;

    static constexpr auto fields() {
        using R = PredictedPoseRow;
        return std::tuple{field("t", &R::t, {"{data}", "time"}),
                          field("rod", &R::rod, {"1", "which rod, from 0"}),
                          field("coordinate", &R::coordinate, {"1", "0: x, 1: y, 2: heading"}),
                          field("data", &R::data, {"{data}", "measured; headings in rad"}),
                          field("median", &R::median, {"{data}", "median of the posterior"}),
                          field("low", &R::low, {"{data}", "2.5 % of the posterior"}),
                          field("high", &R::high, {"{data}", "97.5 % of the posterior"}),
                          field("noise_low", &R::noise_low, {"{data}", "a datum then: 2.5 %"}),
                          field("noise_high", &R::noise_high, {"{data}", "a datum then: 97.5 %"})};
    }
};

/// models.csv, behind the model's name
struct FitModelRow {
    double weight = 0.0, log_evidence = std::nan(""), evidence_error = std::nan(""), aic = std::nan(""),
           bic = std::nan(""), parameters = 0.0, chi2 = std::nan(""), dof = std::nan(""),
           misfit = std::nan(""), foretold = std::nan(""), foretold_error = std::nan(""),
           foretold_difference = std::nan(""), difference_error = std::nan("");

    static constexpr auto fields() {
        using R = FitModelRow;
        return std::tuple{
            field("weight", &R::weight, {"1", "probability of the model among those offered"}),
            field("log_evidence", &R::log_evidence,
                  {"1", "logarithm of the evidence (empty: not requested)"}),
            field("log_evidence_stderr", &R::evidence_error, {"1", "its standard error"}),
            field("aic", &R::aic, {"1", "Akaike's criterion, up to what all models share"}),
            field("bic", &R::bic, {"1", "Bayesian criterion, likewise"}),
            field("parameters", &R::parameters, {"1", "number of free parameters"}),
            field("chi2", &R::chi2, {"1", "sum of the squared residuals"}),
            field("dof", &R::dof, {"1", "independent values less free parameters"}),
            field("misfit", &R::misfit, {"1", "probability of a misfit like this if the model is right"}),
            field("foretold", &R::foretold,
                  {"1", "log-likelihood of stretches of the data, each predicted by a fit of the others"}),
            field("foretold_stderr", &R::foretold_error, {"1", "its standard error"}),
            field("foretold_difference", &R::foretold_difference,
                  {"1", "the same, less the value of the best model"}),
            field("foretold_difference_stderr", &R::difference_error,
                  {"1", "standard error of this difference"})};
    }
};

/// fit_map_<i>.csv: a row a bin
struct FitMapRow {
    double x, y, Ux, Uy, sigma_x, sigma_y, model_Ux, model_Uy, known, used;

    static constexpr auto fields() {
        using R = FitMapRow;
        return std::tuple{
            field("x", &R::x, {"{data}", "distance ahead of the rod"}),
            field("y", &R::y, {"{data}", "distance to the left of the rod"}),
            field("Ux", &R::Ux, {"{data}", "measured displacement along the heading (empty: no data)"}),
            field("Uy", &R::Uy, {"{data}", "measured displacement across (empty: no data)"}),
            field("sigma_x", &R::sigma_x, {"{data}", "standard error of Ux as used (empty: unknown)"}),
            field("sigma_y", &R::sigma_y, {"{data}", "standard error of Uy as used (empty: unknown)"}),
            field("model_Ux", &R::model_Ux, {"{data}", "fitted displacement along the heading"}),
            field("model_Uy", &R::model_Uy, {"{data}", "fitted displacement across"}),
            field("known", &R::known, {"1", "1: there are data"}),
            field("used", &R::used, {"1", "1: fitted, 0: masked or without data"})};
    }
};

} // namespace rodwake::app
