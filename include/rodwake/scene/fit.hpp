#pragma once
// The [fit] table of a scene, after every value is checked. Lengths are in the unit of the profiles,
// Fit::length_unit, whatever `units` says; strings with a unit are converted to it. Whether a file is there
// and what it holds is not known here.

#include "rodwake/core/periodic.hpp"
#include "rodwake/fitting/method.hpp"
#include "rodwake/fitting/prior.hpp"

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::scene {

enum class FitRole { fit, predict };

/// What the first row of a track is; automatic: fitted where sigma_position is given.
enum class StartPoses { automatic, fitted, exact };

/// Columns of a file in units of their own; empty: Fit::length_unit, which the factors lead to.
struct ColumnUnits {
    std::string place, value;
    double place_factor = 1.0, value_factor = 1.0;

    bool operator==(const ColumnUnits&) const = default;
};

/// [low, high] of a parameter.
struct Interval {
    double low = 0.0, high = 0.0;

    bool operator==(const Interval&) const = default;
};

/// value = factor times the parameter `to`.
struct Tie {
    std::string to;
    double factor = 1.0;

    bool operator==(const Tie&) const = default;
};

/// [[fit.profiles]]
struct FitProfile {
    std::string file;
    std::string component = "Ux"; ///< Ux | Uy
    std::string along = "x";      ///< x | y
    double at = 0.0;
    std::vector<double> range; ///< [from, to] of the places that are read; empty: all
    FitRole role = FitRole::fit;
    std::string name;         ///< empty: from the file's
    ColumnUnits columns = {}; ///< of x, and of value and sigma

    bool operator==(const FitProfile&) const = default;
};

/// [[fit.trajectories]], numbers as in the file.
struct FitTrajectory {
    std::string file;
    std::vector<long> rods = {};                         ///< which of the file, from 0; empty: all
    std::optional<double> sigma_position, sigma_heading; ///< absent: 1, and errors from the scatter
    bool free_headings = false;
    StartPoses start_poses = StartPoses::automatic;
    std::optional<double> contact_distance, contact_time, sigma_contact;
    std::optional<double> independent_time; ///< rows closer than this share noise; absent: all independent
    double f_over_mu = 1.0, speed = 1.0;    ///< what the reduced units are in the file's numbers; those of
                                            ///< [scales] by default in an SI scene
    std::string name;                       ///< empty: from the file's

    bool operator==(const FitTrajectory&) const = default;
};

/// [[fit.maps]]: displacement on a grid, of one run or of several alike.
struct FitMap {
    std::vector<std::string> files;
    std::optional<double> speed; ///< absent: as the file has it
    std::vector<double> box;     ///< sides along and across the heading; empty: as the file has it
    std::string name;            ///< empty: from the files
    ColumnUnits columns = {};    ///< of a table: of x and y, and of displacements and sigmas

    bool operator==(const FitMap&) const = default;
};

/// [[fit.masks]]: which bins of the maps are left out; the first is that of the fit.
struct FitMask {
    double strip = 0.0, radius = 0.0;
    std::vector<double> sector; ///< [from, to], rad; empty: all round

    bool operator==(const FitMask&) const = default;
};

/// [[fit.compare]]: other values, drawn and scored beside the fit; parameters not named are as fitted. Of a
/// fit of maps with an isotropic medium: the wake of a point force with these values, without moments.
struct FitCompare {
    std::string name;
    std::map<std::string, double> values;
    std::optional<long> line; ///< the profile, from 0, of which a fit by itself gives f_over_mu, eta and xi

    bool operator==(const FitCompare&) const = default;
};

/// [fit.posterior]
struct FitPosterior {
    std::size_t chains = 4, samples = 4000; ///< kept, of all chains together
    bool evidence = false; ///< of the fit and, with [[fit.models]], of its rivals, which are sampled for it
    std::map<std::string, fitting::Prior> priors; ///< absent: uniform between the bounds

    bool operator==(const FitPosterior&) const = default;
};

/// [[fit.models]]: a rival of the fit, with some keys changed.
struct FitModel {
    std::string name;             ///< file-name safe
    std::vector<std::string> set; ///< "fit.parameters=[\"kappa\"]", as for -s

    bool operator==(const FitModel&) const = default;
};

struct Fit {
    std::string name = "scene";          ///< beside [[fit.models]]
    std::vector<std::string> parameters; ///< the free ones
    std::map<std::string, double> start; ///< absent: fit_default_start
    std::map<std::string, Interval> bounds;
    std::map<std::string, double> fixed;
    std::map<std::string, double> fixed_errors; ///< standard errors of some of `fixed`
    std::map<std::string, Tie> tied;
    bool measured_drag = false; ///< drag_area is fixed at what the run measured, with its error
    std::vector<std::string> log = {"eta", "xi", "alpha"};
    std::optional<PeriodicBox> box; ///< absent: infinite plane
    double heading = 0.0;           ///< rad
    double core = 0.0;
    std::optional<double> independent_spacing;
    double rod_length = 0.0, source_width = 1.0; ///< of the source in maps
    fitting::SearchOptions search;
    std::vector<std::string> likelihood;
    std::string length_unit = "a";
    std::vector<FitProfile> profiles;
    std::vector<FitTrajectory> trajectories;
    std::vector<FitMap> maps;
    std::vector<FitMask> masks; ///< empty: every bin with data
    std::vector<FitCompare> compare;
    std::optional<FitPosterior> posterior;
    std::vector<FitModel> models;

    bool operator==(const Fit&) const = default;
};

inline bool fits_start(const FitTrajectory& track) {
    return track.start_poses == StartPoses::automatic ? track.sigma_position.has_value()
                                                      : track.start_poses == StartPoses::fitted;
}

/// Names a parameter may have.
std::span<const std::string_view> fit_parameter_names();
/// Where a parameter starts without an entry in fit.start: xi at 10 for profiles, at 1 for tracks alone.
double fit_default_start(const Fit& fit, const std::string& parameter);
/// Whether it belongs to maps alone.
bool is_map_parameter(std::string_view parameter);
/// Bounds of a parameter: those given, else [1e-6, 1e6] for eta, xi and alpha, nothing for others.
std::optional<Interval> fit_bounds(const Fit& fit, const std::string& parameter);
/// Whether it is searched in its logarithm: named in fit.log and bounded away from 0.
bool fit_in_log(const Fit& fit, const std::string& parameter);
/// Whether it is free, fixed or tied.
bool fit_has(const Fit& fit, const std::string& parameter);
bool fit_is_free(const Fit& fit, const std::string& parameter);
/// Whether its maps are fitted with an isotropic medium: by the parameters of the theory, f_over_mu and eta.
bool fit_is_isotropic(const Fit& fit);
/// Whether it has the screening length in one of its forms.
bool fit_knows_xi(const Fit& fit);
/// The parameters of the fit, free, fixed and tied, in the order of fit_parameter_names.
std::vector<std::string> fit_used(const Fit& fit);

} // namespace rodwake::scene
