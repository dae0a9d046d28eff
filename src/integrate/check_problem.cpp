#include "run.hpp"

#include "rodwake/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rodwake::integrate {

namespace {

/// Below this CVODES finds its own round-off; above the other the error estimate means nothing.
constexpr double min_rtol = 1e-13, max_rtol = 0.1;

/// The message is put together only where it is needed: there are a dozen checks to a run, and one to an
/// output.
template<class... Values>
void require(bool legal, fmt::format_string<Values...> message, Values&&... values) {
    if (!legal)
        throw InputError("cannot integrate: " + fmt::format(message, std::forward<Values>(values)...));
}

} // namespace

void check_problem(const OdeProblem& problem, const OdeOptions& options,
                   std::span<const double> output_times) {
    require(static_cast<bool>(problem.rhs), "the problem has no right-hand side");
    for (std::size_t i = 0; i < problem.events.size(); ++i)
        require(static_cast<bool>(problem.events[i].value), "event {} ('{}') has no function", i,
                problem.events[i].name);
    const std::vector<double>& y = problem.initial_state;
    require(!y.empty(), "the initial state is empty");
    for (std::size_t i = 0; i < y.size(); ++i)
        if (!std::isfinite(y[i]))
            require(false, "the initial value of {} is {}; it must be finite",
                    problem.component_name ? problem.component_name(i) : fmt::format("y[{}]", i), y[i]);
    require(options.rtol >= min_rtol && options.rtol <= max_rtol, "rtol is {}; it must lie from {} to {}",
            options.rtol, min_rtol, max_rtol);
    require(options.atol > 0.0 && std::isfinite(options.atol), "atol is {}; it must be positive and finite",
            options.atol);
    require(options.max_steps > 0, "max_steps is {}; it must be at least 1", options.max_steps);
    require(options.segment_steps > 0, "segment_steps is {}; it must be at least 1", options.segment_steps);
    require(options.initial_step >= 0.0 && std::isfinite(options.initial_step),
            "initial_step is {}; it must be positive, or 0 for automatic", options.initial_step);
    require(options.max_step >= 0.0 && std::isfinite(options.max_step),
            "max_step is {}; it must be positive, or 0 for none", options.max_step);
    const auto algebraic = static_cast<std::size_t>(std::ranges::count(problem.algebraic, true));
    require(problem.algebraic.empty() || problem.algebraic.size() == problem.initial_state.size(),
            "{} components are marked as algebraic or not, but there are {} components",
            problem.algebraic.size(), problem.initial_state.size());
    require(algebraic == 0 || algebraic < problem.initial_state.size(),
            "every component is algebraic; nothing moves");
    require(algebraic == 0 || options.method == Method::bdf,
            "components are algebraic, and method {} has none; use bdf", to_string(options.method));
    require(!problem.project || options.method != Method::adams,
            "the problem has a projection, and method adams takes none; use bdf or erk");
    require(std::isfinite(problem.start_time), "the start time is {}; it must be finite", problem.start_time);
    require(!output_times.empty(), "there are no output times");
    require(output_times.front() >= problem.start_time, "output time 0 is {}, before the start time {}",
            output_times.front(), problem.start_time);
    for (std::size_t i = 0; i < output_times.size(); ++i) {
        require(std::isfinite(output_times[i]), "output time {} is {}; it must be finite", i,
                output_times[i]);
        if (i > 0 && !(output_times[i] > output_times[i - 1]))
            require(false, "output time {} is {}, not after the one before it, {}", i, output_times[i],
                    output_times[i - 1]);
    }
}

} // namespace rodwake::integrate
