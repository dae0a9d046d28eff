#include "problem_calls.hpp"

#include "step_failure.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace rodwake::integrate {

namespace {

/// Inside a catch block: the text of the exception in flight.
std::string exception_text() {
    try {
        throw;
    } catch (const std::exception& error) {
        return error.what();
    } catch (...) {
        return "an exception not derived from std::exception";
    }
}

/// x - x is 0 for finite x and NaN otherwise, so one branch serves the whole vector.
bool all_finite(std::span<const double> values) {
    double sum = 0.0;
    for (double value : values)
        sum += value - value;
    return sum == 0.0;
}

std::size_t first_not_finite(std::span<const double> values) {
    std::size_t i = 0;
    while (std::isfinite(values[i]))
        ++i;
    return i;
}

/// Multistep methods let local errors add up that Runge-Kutta steps mostly cancel: on the reference
/// trajectories their error over tolerance is 10 to 100 times larger. These factors bring the three methods
/// to like errors for like tolerances (docs/validation.md, work and precision).
double strictness(Method method) {
    switch (method) {
    case Method::bdf:
        return 0.025;
    case Method::adams:
        return 0.125;
    case Method::erk:
        break;
    }
    return 1.0;
}

} // namespace

ProblemCalls::ProblemCalls(const OdeProblem& problem, const OdeOptions& options)
    : problem_(problem), rtol_(options.rtol * strictness(options.method)),
      atol_(options.atol * strictness(options.method)) {}

std::string ProblemCalls::component_name(std::size_t index) const {
    return problem_.component_name ? problem_.component_name(index) : fmt::format("y[{}]", index);
}

ProblemCalls::Result ProblemCalls::rhs(double t, State y, std::span<double> ydot) noexcept try {
    if (rhs_threw_)
        return give_up;
    ++rhs_evaluations_;
    last_time_ = t;
    problem_.rhs(t, y, ydot);
    if (all_finite(ydot))
        return fine;
    std::size_t bad = first_not_finite(ydot);
    fault_ = fmt::format("the right-hand side of {} was {} at t={}", component_name(bad), ydot[bad], t);
    return try_shorter_step;
} catch (...) {
    rhs_threw_ = true;
    fault_ = fmt::format("the right-hand side threw at t={}: {}", t, exception_text());
    return give_up;
}

ProblemCalls::Result ProblemCalls::jacobian(double t, State y, double* column_major) noexcept try {
    const std::size_t n = y.size();
    Eigen::Map<Eigen::MatrixXd> matrix(column_major, static_cast<Eigen::Index>(n),
                                       static_cast<Eigen::Index>(n));
    matrix.setZero();
    problem_.jacobian(t, y, matrix);
    std::span<const double> values(column_major, n * n);
    if (all_finite(values))
        return fine;
    std::size_t bad = first_not_finite(values);
    fault_ = fmt::format("the Jacobian entry d({})'/d({}) was {} at t={}", component_name(bad % n),
                         component_name(bad / n), values[bad], t);
    return try_shorter_step;
} catch (...) {
    fault_ = fmt::format("the Jacobian threw at t={}: {}", t, exception_text());
    return give_up;
}

/// SUNDIALS bounds the mean square of the weighted errors, in which one pair among a thousand idle rods would
/// hardly count. With the root of the size in the weights it bounds their sum.
void ProblemCalls::error_weights(State y, std::span<double> weights) const noexcept {
    constexpr double round_off =
        4.0 * std::numeric_limits<double>::epsilon(); // below it no step can be accepted
    const double share = 1.0 / std::sqrt(static_cast<double>(y.size()));
    for (std::size_t i = 0; i < y.size(); ++i) {
        const double size = std::abs(y[i]), tolerance = rtol_ * std::min(size, problem_.relative_cap) + atol_;
        weights[i] = 1.0 / std::max(share * tolerance, round_off * size);
    }
}

double ProblemCalls::event(std::size_t index, double t, State y) {
    const Event& event = problem_.events[index];
    ++event_evaluations_;
    double value = 0.0;
    try {
        value = event.value(t, y);
    } catch (...) {
        throw StepFailure{"RTFUNC_FAIL",
                          fmt::format("event '{}' threw at t={}: {}", event.name, t, exception_text())};
    }
    if (!std::isfinite(value))
        throw StepFailure{"RTFUNC_FAIL", fmt::format("event '{}' was {} at t={}", event.name, value, t)};
    return value;
}

std::optional<double> ProblemCalls::suspect(std::size_t index, const Step& step) const try {
    return problem_.events[index].suspect(step);
} catch (...) {
    throw StepFailure{"RTFUNC_FAIL", fmt::format("event '{}' threw at t={}: {}", problem_.events[index].name,
                                                 step.time, exception_text())};
}

} // namespace rodwake::integrate
