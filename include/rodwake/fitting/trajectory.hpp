#pragma once
// Residuals of rod trajectories against the rods' equations of motion (rods/model.hpp), with forward
// sensitivities.
//
//   name                    meaning                                            unit (reduced: f/mu, f/(mu
//   v0)) kappa, gamma1, gamma2   couplings in the laplacian basis; absent: 0        v0 mu/f; v0 eta medium 1
//   xi | alpha              medium; alpha = 1/xi                               f/mu; 1
//   stall_overlap           of rods with bodies (rods/body.hpp)                1
//   mobility_ratio          of rods with bodies                                1
//   D_r, D_t                diffusion of the rods (rods/noise.hpp): theirs, not the measurement's   mu v0/f;
//   f v0/mu heading.<k>.<a>         initial heading of rod a of trajectory k, if free  rad x.<k>.<a>,
//   y.<k>.<a>    its initial place, with Trajectory::free_start    f/mu
//
// Beside profiles (wake.hpp) alpha is the parameter that means the same for both: xi is in reduced units here
// and in the unit of the profiles there.

#include "rodwake/core/periodic.hpp"
#include "rodwake/fitting/problem.hpp"
#include "rodwake/integrate/ode.hpp"
#include "rodwake/rods/body_shape.hpp"

#include <optional>

namespace rodwake::fitting {

/// One trajectory, in reduced units. The first row is the start and taken as exact, unless its headings or
/// all of it are free: they are parameters then, and the row is data like the others. Headings are compared
/// as they are, so turns count.
struct Trajectory {
    std::string name;
    std::vector<double> times;               ///< increasing
    std::vector<std::vector<double>> states; ///< x, y, heading of each rod in turn, at each time
    double sigma_position = 1.0, sigma_heading = 1.0;
    bool free_headings = false;             ///< of the first row
    std::optional<double> contact_distance; ///< the run stops there; needed by contact_time
    std::optional<double> contact_time;     ///< a datum: when the rods met
    double sigma_contact = 1.0;
    std::vector<std::string> where;      ///< each row's origin for messages
    std::optional<PeriodicBox> box = {}; ///< the periodic box it was measured in, positions unwrapped;
                                         ///< absent: infinite plane
    double independent = 1.0;    ///< independent rows a row is worth, in (0, 1]: below 1 if neighbours share
                                 ///< noise; sigmas of rows are enlarged by 1/sqrt(independent)
    bool free_start = false;     ///< places and headings of the first row
    rods::RodBodies bodies = {}; ///< of its rods, whose first row may overlap; its numbers hold unless
                                 ///< stall_overlap or mobility_ratio is a parameter
};

/// rtol 1e-10, as fits to 1e-6 need, and few steps, so that a search that strays to violent couplings turns
/// back instead of solving them.
integrate::OdeOptions trajectory_ode_options();

struct TrajectoryModel {
    integrate::OdeOptions ode = trajectory_ode_options();
};

/// Adds the parameters of free starts that are not there yet (start: the first row's).
///
/// A model run that ends by contact before a datum has, for the rows after it, the state at contact. Without
/// a contact distance a run ends where rods come a hundred times closer than in any row, since no solve gets
/// past a collision. A run that has not met within four times contact_time is taken to meet as if the closest
/// pair closed in at speed 1 from there, which keeps the residual continuous. Where a contact is only grazed
/// the residuals jump: fits across that need several starts.
///
/// With D_r or D_t, fixed ones too, rows follow from the rows before them (fitting/noisy_trajectory.cpp), and
/// the poses at the start are no parameters. Of a linear problem, as headings without couplings, the
/// likelihood is exact; how far it holds otherwise is in studies/reports/fitting.md.
///
/// The Jacobian has columns for the parameters that are not fixed. Serial; one evaluation is one solve for
/// each trajectory. Throws InputError for unknown or missing parameters, rows of unequal length, times not
/// increasing, numbers that are not finite, rods in the same place, sigma <= 0, fewer data than free
/// parameters, method erk. The residuals throw RunError where a solve fails.
Problem trajectory_problem(const TrajectoryModel& model, const std::vector<Trajectory>& trajectories,
                           std::vector<Parameter> parameters);

/// Variance that the noise of the rods adds to predict(), by row and component; nothing without it.
std::vector<std::vector<double>> noise_variance(const Trajectory& trajectory, std::size_t index,
                                                const std::vector<Parameter>& parameters,
                                                std::span<const double> values);

/// Whether it is of the kind heading.<k>.<a>, x.<k>.<a> or y.<k>.<a>.
bool is_start_pose(const std::string& name);

/// The model's states at the trajectory's times, for figures. `index`: k of its heading.<k>.<a>.
std::vector<std::vector<double>> predict(const TrajectoryModel& model, const Trajectory& trajectory,
                                         std::size_t index, const std::vector<Parameter>& parameters,
                                         std::span<const double> values);

/// One run of the model at the trajectory's times: predict(), or of rods that diffuse a draw from their
/// noise.
std::vector<std::vector<double>> drawn_states(const TrajectoryModel& model, const Trajectory& trajectory,
                                              std::size_t index, const std::vector<Parameter>& parameters,
                                              std::span<const double> values, std::uint64_t seed,
                                              std::uint32_t run);

std::vector<std::string> trajectory_parameter_names();

/// Both kinds of data at once: the residuals one after the other; parameters matched by name. Throws
/// InputError where two of one name differ in start, bounds or tie, and where sigmas are known for one kind
/// only.
Problem joined(const std::vector<Problem>& problems);

} // namespace rodwake::fitting
