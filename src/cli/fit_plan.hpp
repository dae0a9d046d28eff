#pragma once
// From [fit] and the measured files to a problem of the fitting part and how it is solved.

#include "fit_data.hpp"
#include "log.hpp"
#include "options.hpp"
#include "rodwake/fitting/method.hpp"

namespace rodwake::cli {

struct FitPlan {
    scene::Fit keys;
    std::vector<FitProfileData> profiles; ///< as fit.profiles
    std::vector<FitTrackData> tracks;     ///< as fit.trajectories
    fitting::WakeModel wake;
    fitting::TrajectoryModel track_model;
    fitting::Problem problem;
    fitting::Method method; ///< without the calls that report and stop
};

/// Throws InputError for a file that is missing or wrong, for data that cannot be fitted, and where the
/// residuals at the start are not finite. `run_directory` empty: there is none yet.
FitPlan fit_plan(const scene::Scene& scene, const Options& options,
                 const std::filesystem::path& run_directory);

/// The search as the keys want it, without the calls that report and stop.
fitting::Method fit_method(const scene::Fit& keys, const Options& options);

/// Before a run: the files that the run itself does not make must be there and right. Throws InputError.
void require_fit_files(const scene::Scene& scene, const Options& options);

/// The parameters of the plan that one of the models knows, and where they stand among all.
struct FitPart {
    std::vector<fitting::Parameter> parameters;
    std::vector<std::size_t> index;

    std::vector<double> values(std::span<const double> all) const;
};
FitPart wake_part(const fitting::Problem& problem);
FitPart track_part(const fitting::Problem& problem);

/// The values of a comparison: those named, alpha or xi as the fit has it, the others as fitted.
std::vector<double> compared_values(const FitPlan& plan, const scene::FitCompare& compare,
                                    std::span<const double> fitted);

/// "a", "a^2", "1", ... of a parameter.
std::string fit_unit(const scene::Fit& keys, const std::string& parameter);

} // namespace rodwake::cli
