#pragma once
// The files of a fit: fit.json, fit_profile_<i>.csv, fit_curve_<i>.csv, fit_trajectory_<i>.csv.

#include "rodwake/app/fit_results.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/fitting/method.hpp"
#include "rodwake/fitting/posterior.hpp"
#include "rodwake/store/journal.hpp"
#include "run/log.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <memory>
#include <string>

// Records of the journal of a fit.

namespace rodwake::store {

using fitting::ChainBlock, fitting::StartResult;

template<>
inline constexpr auto parts<StartResult> = parts_of("index start end objective termination evaluations",
                                                    &StartResult::index, &StartResult::start,
                                                    &StartResult::end, &StartResult::objective,
                                                    &StartResult::termination, &StartResult::evaluations);
template<>
inline constexpr auto
    parts<ChainBlock> = parts_of("chain index log_density log_scale accepted z kept kept_density",
                                 &ChainBlock::chain, &ChainBlock::index, &ChainBlock::log_density,
                                 &ChainBlock::log_scale, &ChainBlock::accepted, &ChainBlock::z,
                                 &ChainBlock::kept, &ChainBlock::kept_density);

} // namespace rodwake::store

namespace rodwake::app {

// Errors of a fit beyond its curvature (fitting/refits.hpp): constants that were held, masks, runs.

/// Empty where the scene gives no reason: no fit.fixed_errors, one mask or none, tables of a single map.
/// Nothing if stop_requested of the method said so meanwhile. Throws RunError naming the key where a refit
/// fails.
std::optional<FitSystematics> fit_systematics(const FitPlan& plan, const fitting::Method& method,
                                              const FitResults& results);

/// Who made it, for fit.json.
struct FitOrigin {
    std::string command;
};

/// fit.json comes last: where it is, the others are.
void write_fit(const std::filesystem::path& folder, const FitPlan& plan, const FitResults& results,
               const FitOrigin& origin);

/// Starts and blocks of samples that are done, in the folder of the fit.
inline constexpr const char* journal_file = "fit.log";

// The posterior of a fit, with fit.posterior.

/// As fit.posterior asks for it.
fitting::PosteriorMethod posterior_method(const FitPlan& plan);

/// Its files; blocks of chains that are done are kept in the journal. False if a signal stopped it.
bool add_posterior(const FitPlan& plan, const fitting::Fit& fit, store::Journal& journal,
                   const RunContext& context, const std::filesystem::path& folder, const Logger& log);

/// posterior.csv, posterior.nc, what the samples predict, and last posterior.json.
void write_posterior(const std::filesystem::path& folder, const FitPlan& plan,
                     const fitting::Posterior& found, const RunContext& context);

/// posterior_curve_<k>.csv and posterior_trajectory_<k>.csv.
void write_predictions(const std::filesystem::path& folder, const FitPlan& plan,
                       const fitting::Posterior& found, std::size_t threads);

/// The model along a profile's line, with derivatives by all parameters of the fit.
fitting::Prediction predicted_line(const FitPlan& plan, const fitting::Profile& line,
                                   std::span<const double> places, std::span<const double> values);

/// Rivals in models/<name>/, and all of them weighed in models.json and models.csv. Nothing without
/// [[fit.models]]. False if a signal stopped it.
bool add_models(const scene::Scene& scene, const FitPlan& plan, const FitResults& results,
                const RunContext& context, const std::filesystem::path& folder, const Logger& log);

/// Member `misfit` of fit.json and of models.json.
nlohmann::ordered_json misfit_json(const fitting::Misfit& misfit);

} // namespace rodwake::app
