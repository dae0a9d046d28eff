#include "rodwake/integrate/sensitivity.hpp"

#include "run.hpp"

#include "rodwake/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rodwake::integrate {

namespace {

void require(bool legal, const std::string& message) {
    if (!legal)
        throw InputError("cannot integrate sensitivities: " + message);
}

} // namespace

SensitivitySolution solve_with_sensitivities(const SensitivityProblem& problem, const OdeOptions& options,
                                             std::span<const double> output_times) {
    check_problem(problem.ode, options, output_times);
    require(problem.parameters > 0, "there are no parameters; use solve()");
    require(static_cast<bool>(problem.ode.jacobian), "the problem has no Jacobian");
    require(!problem.ode.project && problem.ode.algebraic.empty(),
            "sensitivities of projected or constrained problems are not offered");
    require(static_cast<bool>(problem.by_parameter), "the problem has no derivatives by the parameters");
    for (std::size_t i = 0; i < problem.ode.events.size(); ++i)
        require(!problem.ode.events[i].terminal ||
                    (i < problem.event_gradient.size() && problem.event_gradient[i]),
                fmt::format("terminal event {} ('{}') has no gradient", i, problem.ode.events[i].name));
    const auto n = static_cast<Eigen::Index>(problem.ode.initial_state.size()),
               parameters = static_cast<Eigen::Index>(problem.parameters);
    require(problem.initial.rows() == n && problem.initial.cols() == parameters,
            fmt::format("the initial sensitivities are {} x {}; they must be {} x {}, states x parameters",
                        problem.initial.rows(), problem.initial.cols(), n, parameters));
    require(problem.initial.allFinite(), "an initial sensitivity is not finite");
    require(problem.parameter_scale.size() == problem.parameters,
            fmt::format("there are {} parameter scales for {} parameters", problem.parameter_scale.size(),
                        problem.parameters));
    for (std::size_t j = 0; j < problem.parameters; ++j)
        require(problem.parameter_scale[j] > 0.0 && std::isfinite(problem.parameter_scale[j]),
                fmt::format("the scale of parameter {} is {}; it must be positive and finite", j,
                            problem.parameter_scale[j]));
    require(options.method != Method::erk, "method erk has none; use adams or, if the problem is stiff, bdf");
    return Run(problem.ode, &problem, options, output_times).execute();
}

} // namespace rodwake::integrate
