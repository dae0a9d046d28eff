#pragma once
// Problems with known solutions, shared by the tests of this folder.

#include "rodwake/integrate/ode.hpp"

#include <cmath>

namespace rodwake::integrate::test {

inline constexpr Method all_methods[] = {Method::bdf, Method::adams, Method::erk};

inline OdeOptions options_for(Method method, double rtol) {
    OdeOptions options;
    options.method = method;
    options.rtol = rtol;
    options.atol = 0.01 * rtol; // the solutions here are of order 1: rtol rules
    return options;
}

/// y' = -y, y = exp(-t).
inline OdeProblem decay() {
    OdeProblem problem;
    problem.initial_state = {1.0};
    problem.rhs = [](double, State y, std::span<double> ydot) { ydot[0] = -y[0]; };
    problem.jacobian = [](double, State, Eigen::Ref<Eigen::MatrixXd> jacobian) { jacobian(0, 0) = -1.0; };
    return problem;
}

/// x = cos t, v = -sin t.
inline OdeProblem oscillator() {
    OdeProblem problem;
    problem.initial_state = {1.0, 0.0};
    problem.rhs = [](double, State y, std::span<double> ydot) {
        ydot[0] = y[1];
        ydot[1] = -y[0];
    };
    return problem;
}

/// y = y0 + v0 t + a t^2 / 2 as the state (y, v).
inline OdeProblem ballistic(double y0, double v0, double acceleration) {
    OdeProblem problem;
    problem.initial_state = {y0, v0};
    problem.rhs = [acceleration](double, State y, std::span<double> ydot) {
        ydot[0] = y[1];
        ydot[1] = acceleration;
    };
    return problem;
}

inline std::vector<double> evenly(double from, double to, int intervals) {
    std::vector<double> times;
    for (int i = 0; i <= intervals; ++i)
        times.push_back(from + (to - from) * i / intervals);
    return times;
}

/// The event of component i crossing zero.
inline Event component_event(std::size_t i, Crossing crossing, bool terminal) {
    return {"y" + std::to_string(i), [i](double, State y) { return y[i]; }, crossing, terminal};
}

} // namespace rodwake::integrate::test
