#include "user_functions.hpp"

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

/// x - x is 0 for finite x and NaN otherwise, so one branch serves the whole vector. Two sums, so that one
/// need not wait for the other.
bool all_finite(std::span<const double> values) {
    double even = 0.0, odd = 0.0;
    std::size_t i = 0;
    for (; i + 1 < values.size(); i += 2) {
        even += values[i] - values[i];
        odd += values[i + 1] - values[i + 1];
    }
    if (i < values.size())
        even += values[i] - values[i];
    return even + odd == 0.0;
}

std::size_t first_not_finite(std::span<const double> values) {
    std::size_t i = 0;
    while (std::isfinite(values[i]))
        ++i;
    return i;
}

/// Multistep methods let local errors add up that Runge-Kutta steps mostly cancel: on the reference
/// trajectories their error over tolerance is 10 to 100 times larger. These factors bring the three methods
/// to like errors for like tolerances (studies/reports/rods.md, work and precision).
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

UserFunctions::UserFunctions(const OdeProblem& problem, const OdeOptions& options,
                             const SensitivityProblem* sensitivity)
    : problem_(problem), sensitivity_(sensitivity), rtol_(options.rtol * strictness(options.method)),
      atol_(options.atol * strictness(options.method)) {}

std::string UserFunctions::component_name(std::size_t index) const {
    return problem_.component_name ? problem_.component_name(index) : fmt::format("y[{}]", index);
}

UserFunctions::CallbackResult UserFunctions::rhs(double t, State y, std::span<double> ydot) noexcept try {
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

UserFunctions::CallbackResult UserFunctions::jacobian(double t, State y, double* column_major) noexcept try {
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

UserFunctions::CallbackResult UserFunctions::linearise(double t, State y) {
    if (t == linear_.time && std::equal(y.begin(), y.end(), linear_.state.begin(), linear_.state.end()))
        return fine;
    linear_.time = std::numeric_limits<double>::quiet_NaN(); // until both are there
    const auto n = static_cast<Eigen::Index>(y.size()),
               parameters = static_cast<Eigen::Index>(sensitivity_->parameters);
    linear_.by_state.resize(n, n);
    if (const CallbackResult result = jacobian(t, y, linear_.by_state.data()); result != fine)
        return result;
    linear_.by_parameter.setZero(n, parameters);
    sensitivity_->by_parameter(t, y, linear_.by_parameter);
    if (!linear_.by_parameter.allFinite()) {
        fault_ =
            fmt::format("a derivative of the right-hand side by the parameters was not finite at t={}", t);
        return try_shorter_step;
    }
    linear_.time = t;
    linear_.state.assign(y.begin(), y.end());
    return fine;
}

UserFunctions::CallbackResult UserFunctions::sensitivity_rhs(double t, State y, const Eigen::MatrixXd& S,
                                                             Eigen::MatrixXd& S_dot) noexcept try {
    if (rhs_threw_)
        return give_up;
    const CallbackResult result = linearise(t, y);
    rhs_threw_ = result == give_up;
    if (result == fine)
        S_dot.noalias() = linear_.by_state * S + linear_.by_parameter;
    return result;
} catch (...) {
    rhs_threw_ = true;
    fault_ = fmt::format("the derivatives of the right-hand side by the parameters threw at t={}: {}", t,
                         exception_text());
    return give_up;
}

/// The share of one component, as in error_weights. Not capped: a sensitivity has an origin.
double UserFunctions::sensitivity_rtol() const {
    return rtol_ / std::sqrt(static_cast<double>(problem_.initial_state.size()));
}

double UserFunctions::sensitivity_atol(std::size_t parameter) const {
    return atol_ / std::sqrt(static_cast<double>(problem_.initial_state.size())) /
           sensitivity_->parameter_scale[parameter];
}

/// SUNDIALS bounds the mean square of the weighted errors, in which one pair among a thousand idle rods would
/// hardly count. With the root of the size in the weights it bounds their sum.
void UserFunctions::error_weights(State y, std::span<double> weights) const noexcept {
    constexpr double round_off =
        4.0 * std::numeric_limits<double>::epsilon(); // below it no step can be accepted
    const double share = 1.0 / std::sqrt(static_cast<double>(y.size()));
    const std::vector<bool>& algebraic = problem_.algebraic;
    for (std::size_t i = 0; i < y.size(); ++i) {
        const bool capped = algebraic.empty() || !algebraic[i]; // a multiplier has an origin
        const double size = std::abs(y[i]),
                     tolerance = rtol_ * (capped ? std::min(size, problem_.relative_cap) : size) + atol_;
        weights[i] = 1.0 / std::max(share * tolerance, round_off * size);
    }
}

double UserFunctions::event(std::size_t index, double t, State y) {
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

Eigen::VectorXd UserFunctions::event_gradient(std::size_t index, double t, State y) const {
    const auto fail = [&](const std::string& what) {
        return StepFailure{"RTFUNC_FAIL", fmt::format("the gradient of event '{}' {} at t={}",
                                                      problem_.events[index].name, what, t)};
    };
    Eigen::VectorXd gradient;
    try {
        gradient = sensitivity_->event_gradient[index](t, y);
    } catch (...) {
        throw fail("threw " + exception_text());
    }
    const auto size = static_cast<std::size_t>(gradient.size());
    if (size != y.size() && size != y.size() + sensitivity_->parameters)
        throw fail(fmt::format("has {} components, neither {} nor {}", size, y.size(),
                               y.size() + sensitivity_->parameters));
    return gradient;
}

std::optional<double> UserFunctions::candidate_time(std::size_t index, const Step& step) const try {
    return problem_.events[index].candidate_time(step);
} catch (...) {
    throw StepFailure{"RTFUNC_FAIL", fmt::format("event '{}' threw at t={}: {}", problem_.events[index].name,
                                                 step.time, exception_text())};
}

} // namespace rodwake::integrate
