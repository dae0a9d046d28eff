#pragma once
// One run of the rods' equations for given parameter values, with its derivatives by them.

#include "rodwake/fitting/trajectory.hpp"
#include "rodwake/rods/sensitivity.hpp"

#include <optional>

namespace rodwake::fitting {

/// What a parameter is to the trajectories.
struct Role {
    std::optional<rods::Parameter> physical = {}; ///< empty: a component of the initial pose of a rod
    bool inverse = false;                         ///< alpha = 1/xi
    bool flow = false;                            ///< gamma_flow, which is two polar couplings
    enum class Diffusion { rotational, translational };
    std::optional<Diffusion> diffusion = {};            ///< D_r, D_t
    std::size_t trajectory = 0, rod = 0, component = 2; ///< 0, 1, 2: x, y, heading

    bool of_start() const { return !physical && !flow && !diffusion; }
    bool matters_to(std::size_t item) const { return !of_start() || trajectory == item; }
};

/// "heading.<trajectory>.<rod>", "x. ...", "y. ..."
std::string pose_name(std::size_t trajectory, std::size_t rod, std::size_t component);

/// Whether the component of the first row is a parameter.
inline bool is_free(const Trajectory& track, std::size_t component) {
    return track.free_start || (track.free_headings && component % 3 == 2);
}

/// Throws InputError for a name that means nothing here.
Role role_of(const std::string& name, const std::vector<Trajectory>& trajectories);

/// Of parameters among which is D_r or D_t. Throws InputError for tracks that a filter cannot use.
Problem noisy_problem(const std::vector<Trajectory>& trajectories, std::vector<Parameter> parameters);

/// How long the model runs after its last datum in search of a contact that is a datum, in contact times.
inline constexpr double contact_patience = 4.0;

/// The rods of a trajectory as a problem, times from its first row on.
rods::RodProblem rod_problem(const Trajectory& trajectory, std::size_t index, std::span<const Role> roles,
                             std::span<const double> values);

/// The model at the rows of a trajectory. A run that ended by contact stays in the state it had then.
struct ModelRun {
    std::vector<Eigen::VectorXd> states;      ///< at each row
    std::vector<Eigen::MatrixXd> derivatives; ///< of each row by all parameters; empty unless wanted
    double contact_time = 0.0;                ///< since the first row, if it is a datum
    Eigen::VectorXd contact_time_by_parameter;
};

/// `wanted`: the parameters to differentiate by, or null for none. Throws RunError if the solve fails.
ModelRun run_model(const integrate::OdeOptions& options, const Trajectory& trajectory, std::size_t index,
                   std::span<const Role> roles, std::span<const double> values,
                   const std::vector<bool>* wanted);

/// Throws InputError, naming row and trajectory.
void check_trajectories(const std::vector<Trajectory>& trajectories);

/// Throws InputError unless the medium is there and something couples the rods to it.
void check_trajectory_parameters(const std::vector<Parameter>& parameters);

/// A row's origin for messages.
std::string row_name(const Trajectory& trajectory, std::size_t row);

} // namespace rodwake::fitting
