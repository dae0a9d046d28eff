#pragma once
// Initial-value problems with forward sensitivities S_j = dy/dp_j by CVODES:
//
//   y' = f(t, y; p),   S_j' = (df/dy) S_j + df/dp_j,   S_j(t0) = dy(t0)/dp_j

#include "rodwake/integrate/ode.hpp"

namespace rodwake::integrate {

struct SensitivityProblem {
    OdeProblem ode; ///< jacobian required
    std::size_t parameters = 0;
    /// d f_i/d p_j into (i, j), states x parameters, all zero on entry.
    std::function<void(double t, State y, Eigen::Ref<Eigen::MatrixXd> by_parameter)> by_parameter;
    Eigen::MatrixXd initial; ///< dy(t0)/dp, states x parameters
    /// Typical size of each parameter, > 0. The tolerance of component i of S_j is rtol |S_ij| +
    /// atol/scale_j.
    std::vector<double> parameter_scale;
    /// Gradient of each event's value by y, followed by that by p if it depends on p; in the order of
    /// ode.events. Needed for terminal events, whose value must not depend on t itself.
    std::vector<std::function<Eigen::VectorXd(double t, State y)>> event_gradient;
};

struct SensitivitySolution {
    Solution solution;
    std::vector<Eigen::MatrixXd> sensitivities; ///< dy/dp at solution.times[k], at fixed time
    /// At the end, at fixed time. If a terminal event ended it: the total derivative of the final state
    /// follows as final + f dt/dp.
    Eigen::MatrixXd final_sensitivity;
    /// d(event time)/dp = -(grad g . S + dg/dp)/(grad g . f), infinite where an event is only grazed; empty
    /// if no terminal event ended the solve.
    Eigen::VectorXd event_time_by_parameter;
};

/// Adams or BDF (method erk: InputError), staggered corrector. Error control includes the sensitivities, each
/// as if it were a state of its own. Everything else as solve(): failures are values.
SensitivitySolution solve_with_sensitivities(const SensitivityProblem& problem, const OdeOptions& options,
                                             std::span<const double> output_times);

} // namespace rodwake::integrate
