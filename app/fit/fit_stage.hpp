#pragma once
// The steps of the fit stage: fit_stage.cpp solves, log_fit.cpp logs, write_fit.cpp and write_posterior.cpp
// write the files, fit_models.cpp compares models, fitted_medium.cpp hands the medium to later stages.

#include "rodwake/app/fit_results.hpp"
#include "rodwake/fitting/method.hpp"
#include "rodwake/fitting/posterior.hpp"
#include "rodwake/store/journal.hpp"
#include "run/log.hpp"
#include "run/session.hpp"

#include <filesystem>
#include <string>
#include <utility>

namespace rodwake::store {

// Records of the journal of a fit.

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

/// Journal of the starts and blocks of samples that are done, in the folder of the fit.
inline constexpr const char* journal_file = "fit.log";

struct FitStageResult {
    StageEnd end = StageEnd::failed;
    std::optional<FitResults> results; ///< absent if no start has a finite residual
};

/// Solves the fit and writes its files. Starts and blocks of samples that are done are kept in the folder
/// until forget_progress(); the same command resumes from them.
FitStageResult fit_in_folder(const scene::Scene& scene, const FitPlan& plan, const RunContext& context,
                             const std::filesystem::path& folder, const Logger& log);

/// Removes the journal of a fit that has finished together with its rivals.
void forget_progress(const std::filesystem::path& folder);

/// Inputs on which the result of a fit depends, as text: version, search, model and data.
std::string fit_key(const scene::Scene& scene, const FitPlan& plan);

/// Errors beyond the curvature (fitting/refits.hpp) from held constants, masks and runs. Empty unless the
/// scene has fit.fixed_errors, several masks, or tables of several maps. Returns nothing if stop_requested of
/// the method became true. Throws RunError naming the key of a refit that fails.
std::optional<FitSystematics> fit_systematics(const FitPlan& plan, const fitting::Method& method,
                                              const FitResults& results);

/// Displacements of the model along a profile's line, with derivatives by all parameters of the fit.
fitting::Prediction predicted_line(const FitPlan& plan, const fitting::Profile& line,
                                   std::span<const double> positions, std::span<const double> values);

void log_fit_data(const FitPlan& plan, const Logger& log);
void log_fit_results(const FitPlan& plan, const FitResults& results, const Logger& log);
void log_posterior(const FitPlan& plan, const fitting::Posterior& posterior, const Logger& log);

/// Writes the tables of the fit, then fit.json: if it exists, the tables do, too.
void write_fit(const std::filesystem::path& folder, const FitPlan& plan, const FitResults& results,
               const std::string& command);

/// Writes posterior.csv, posterior.nc, posterior_curve_<k>.csv, posterior_trajectory_<k>.csv, and last
/// posterior.json.
void write_posterior(const std::filesystem::path& folder, const FitPlan& plan,
                     const fitting::Posterior& posterior, const RunContext& context);

/// Fits the rivals of [[fit.models]] in models/<name>/ and writes models.csv and models.json. Does nothing
/// without rivals. Returns false if a signal stopped it.
bool add_models(const scene::Scene& scene, const FitPlan& plan, const FitResults& results,
                const RunContext& context, const std::filesystem::path& folder, const Logger& log);

/// Writes medium.json and makes the medium that of the later stages. Throws RunError if the data do not
/// constrain eta or xi.
void take_fitted_medium(Session& session, const FitResults& results, const FitPlan& plan);

/// With medium.fitted: makes the medium of the medium.json that an earlier fit wrote that of the later
/// stages. Throws InputError.
void take_stored_medium(Session& session);

} // namespace rodwake::app
