#pragma once
// Residuals of measured displacement profiles against the steady field of a moving rod.
//
//   model(x, y) = f_over_mu U(x - x0, y; eta, xi) + f2d_over_mu U_dip(x - x0, y; eta, xi) + offset
//
// in the rod's frame (elastic/field.hpp), in the infinite plane or, with a box, in the periodic one
// (elastic/periodic.hpp). A term takes part if its strength is a parameter, free or fixed; what is absent is
// not evaluated.
//
//   name         meaning                                                                unit (that of the
//   profiles) f_over_mu    monopole: force of the rod over the shear modulus                       length
//   f2d_over_mu  y force dipole +-f2 at +-d/2: f2 d/mu                                   length^2
//   eta          lambda/mu (elastic/medium.hpp)                                          1
//   xi           screening length mu/(zeta v0)                                           length
//   alpha        in place of xi: xi = f_over_mu/alpha                                    1
//   x0           where the force acts, ahead of the rod's centre                         length
//   offset       constant added to U_x; offset_y: to U_y                                 length

#include "rodwake/core/periodic.hpp"
#include "rodwake/fitting/problem.hpp"

#include <optional>

namespace rodwake::fitting {

enum class Component { Ux, Uy };
enum class Axis { x, y };

/// Values along a line parallel to an axis of the rod's frame, in any unit of length, the same for all.
struct Profile {
    std::string name = {}; ///< for messages and reports
    Component component = Component::Ux;
    Axis along = Axis::x;
    double at = 0.0; ///< the other coordinate
    std::vector<double> place = {}, value = {};
    std::vector<double> sigma = {}; ///< standard errors, > 0; empty: equal, unknown
    double independent = 1.0;       ///< independent values a point is worth, in (0, 1]: below 1 if neighbours
                                    ///< share data; sigma is enlarged by 1/sqrt(independent)
    std::vector<std::string> where = {}; ///< each point's origin for messages, "file.csv:7"; may be empty
    std::vector<double> worth = {}; ///< `independent` of each point (independent_worth); empty: all the same
};

struct WakeModel {
    std::optional<PeriodicBox> box = {}; ///< absent: infinite plane
    double heading = 0.0;                ///< of the rod against the box's sides, rad
    double core =
        0.0; ///< points closer than this to the rod's centre along the profile (|x| < core) are left out
};

/// What each row is worth, in (0, 1], if rows of a run closer than `spacing` (> 0) share data: the mean step
/// between the rows within that distance over it, at least one value for all of them together. n rows with
/// the step h are worth n h/spacing, a row that is farther than `spacing` from all others 1, rows in the same
/// place 1 together. A run ends where the places turn back, so that runs written one after the other count
/// each; rows in no order are one run.
std::vector<double> independent_worth(std::span<const double> positions, double spacing);

/// Independent values a row is worth on average.
double mean_worth(std::span<const double> worth);

/// Points of a run closer to each other than `spacing` share data (independent_worth).
void share_data(Profile& profile, double spacing);

/// The part of the profile that is fitted: |place| >= core.
Profile outside_core(const Profile& profile, double core);

/// What residual i of the profile is divided by: sigma, enlarged where neighbours share data; 1 enlarged
/// where sigma is unknown.
double residual_scale(const Profile& profile, std::size_t i);

/// Sum of squared residuals of a prediction; places where it is not finite do not count.
double chi2_of(const Profile& profile, std::span<const double> model);

/// Names the model knows, in canonical order.
std::vector<std::string> wake_parameter_names();

/// Throws InputError for: unknown or missing parameters (eta, and xi or alpha, are needed by monopole and
/// dipole), a profile with numbers that are not finite, sigma <= 0, unequal lengths, no points left outside
/// the core, all values equal over all fitted profiles, fewer points than free parameters, a profile with and
/// one without sigma, a point at the singularity, which every image in the box has too.
Problem wake_problem(const WakeModel& model, const std::vector<Profile>& profiles,
                     std::vector<Parameter> parameters);

/// Model values at places along a profile's line, and their derivatives by all parameters if wanted. NaN at
/// the singularity and its images.
struct Prediction {
    std::vector<double> value;
    Eigen::MatrixXd by_parameter; ///< places x parameters
};
Prediction predict(const WakeModel& model, const Profile& line, std::span<const double> positions,
                   const std::vector<Parameter>& parameters, std::span<const double> values);

/// By what the data exceed a prediction: value = scale * model, by weighted least squares on points outside
/// the core. `model_root`: G with covariance of the model = G G^T, a row a point; the covariance itself would
/// be points x points.
struct ScaleFactor {
    double scale = 1.0,
           standard_error = 0.0; ///< includes the errors of the fitted parameters if model_root is given
    double chi2 = 0.0;           ///< of the prediction itself (scale = 1)
    std::size_t points = 0;
};
ScaleFactor scale_factor(const Profile& data, std::span<const double> model,
                         const Eigen::MatrixXd* model_root = nullptr);

} // namespace rodwake::fitting
