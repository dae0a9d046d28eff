#pragma once
// From [fit] and measured data to a problem of the fitting part and how it is solved. Reading the files is
// not done here (app/fit/fit_data.hpp does).

#include "rodwake/core/estimate.hpp"
#include "rodwake/fitting/map.hpp"
#include "rodwake/fitting/method.hpp"
#include "rodwake/fitting/posterior.hpp"
#include "rodwake/fitting/trajectory.hpp"
#include "rodwake/fitting/wake.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rodwake::app {

/// What one of [[fit.profiles]] names.
struct FitProfileData {
    std::string name;
    std::filesystem::path file; ///< for messages
    fitting::Profile data;
    std::size_t left_out = 0; ///< points of unknown sigma beside others of known
};

/// What one of [[fit.trajectories]] names.
struct FitTrackData {
    std::string name;
    std::filesystem::path file; ///< for messages
    std::size_t rods = 0;
    double length = 1.0, time = 1.0; ///< what a reduced unit is in the file's numbers
    bool sigma_known = false;
    bool unwrapped = false; ///< headings that jumped by turns were brought near those of the row before
    fitting::Trajectory data;
    std::size_t left_out = 0; ///< rows in which a rod is not known
};

/// What one of the files of [[fit.maps]] holds.
struct FitMapData {
    std::string name;
    std::filesystem::path file; ///< for messages
    std::size_t table = 0;      ///< which of [[fit.maps]] names it
    fitting::Map data;
    std::size_t left_out = 0; ///< bins of unknown sigma beside others of known
    bool mirrored = false;    ///< its halves are the same data: those of y < 0 are left out
    std::size_t run = 0;      ///< which run of a file that holds several, from 1; 0: all together

    std::string label() const; ///< file and run
};

/// Settles a track as it was read or given: places go on where they were across the sides of the box,
/// headings are brought within half a turn of the row before, since files give them modulo 2 pi or as one
/// angle of many. Throws InputError where the headings are in degrees.
void settle_track(FitTrackData& track, std::optional<PeriodicBox> box);

/// Settles a map as it was read or given: sigmas that no bin has make equal weights; bins of unknown sigma
/// beside others of known are left out, and so is one half of a map that was averaged with its mirror image;
/// closer bins than `independent_spacing` share their worth.
void settle_map(FitMapData& map, std::optional<double> independent_spacing);

/// The data of a fit, in the order of the scene's tables. Absent: a stage of the run makes the file first.
struct FitInputs {
    std::vector<std::optional<FitProfileData>> profiles;
    std::vector<std::optional<FitTrackData>> tracks;
    std::vector<std::optional<FitMapData>> maps{}; ///< of all tables, one file after the other
    std::optional<Estimate> drag_area{};           ///< with fit.measured_drag

    bool complete() const; ///< but for drag_area
};

struct FitPlan {
    scene::Fit keys;
    std::vector<FitProfileData> profiles; ///< as fit.profiles
    std::vector<FitTrackData> tracks;     ///< as fit.trajectories
    std::vector<FitMapData> maps;         ///< the files of fit.maps
    fitting::MapModel map_model;
    fitting::MapMask mask; ///< the first of fit.masks
    fitting::WakeModel wake;
    fitting::TrajectoryModel track_model;
    fitting::Problem problem;
    fitting::Method method; ///< without threads and the calls that report and stop
};

/// What looks wrong in data that can be fitted: units that differ, rods that do not move along their
/// headings. Throws InputError for tracks in which the rods are ten times too fast or too slow.
std::vector<std::string> data_remarks(const FitPlan& plan);

/// Of the free parameters: uniform between the bounds unless fit.posterior says otherwise. Poses at the start
/// are data, and their prior is wide: ten standard errors either way.
std::vector<fitting::Prior> fit_priors(const FitPlan& plan);

/// How fit.posterior asks to sample.
fitting::PosteriorMethod posterior_method(const FitPlan& plan);

/// Of inputs that are complete. Throws InputError for data that cannot be fitted, and where the residuals at
/// the start are not finite.
FitPlan fit_plan(const scene::Fit& keys, FitInputs inputs);

/// One of fit.models of the scene on the same data as `plan`. Throws InputError, naming the model.
FitPlan model_plan(const scene::Scene& scene, const scene::FitModel& model, const FitPlan& plan,
                   FitInputs inputs);

/// Names of the parameters that its maps are fitted with: of an orthotropic or an isotropic medium.
std::vector<std::string> map_names(const scene::Fit& keys);

/// The problem of the plan's keys and data as they are by now.
fitting::Problem fit_problem(const FitPlan& plan);

fitting::MapMask map_mask(const scene::FitMask& keys);

/// The parameters of the plan that one of the models knows, and where they stand among all.
struct FitPart {
    std::vector<fitting::Parameter> parameters;
    std::vector<std::size_t> index;

    std::vector<double> values(std::span<const double> all) const;
};
FitPart wake_part(const fitting::Problem& problem);
FitPart map_part(const FitPlan& plan);
FitPart track_part(const fitting::Problem& problem);

/// The values of a comparison: those named, alpha or xi as the fit has it, the others as fitted.
std::vector<double> compared_values(const FitPlan& plan, const scene::FitCompare& compare,
                                    std::span<const double> fitted);

/// "a", "a^2", "1", ... of a parameter.
std::string fit_unit(const scene::Fit& keys, const std::string& parameter);

} // namespace rodwake::app
