// An equation of your own, without any rods: a ball that falls, hits the floor and bounces. The solver finds
// each impact as an event, stops there to the last digits, and the next flight starts from that point.

#include <rodwake/integrate/ode.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

constexpr double gravity = 9.81;    // m/s^2
constexpr double restitution = 0.8; // speed after an impact over speed before
constexpr double drop_height = 1.0; // m
constexpr int impacts = 6;

/// y[0] = height, y[1] = velocity.
rodwake::integrate::OdeProblem flight(double start, double height, double velocity) {
    rodwake::integrate::OdeProblem problem;
    problem.start_time = start;
    problem.initial_state = {height, velocity};
    problem.rhs = [](double, rodwake::integrate::State y, std::span<double> ydot) {
        ydot[0] = y[1];
        ydot[1] = -gravity;
    };
    // The floor counts only on the way down. A flight starts on it; an event that is zero at the start waits
    // until it has left zero.
    problem.events.push_back({.name = "floor",
                              .value = [](double, rodwake::integrate::State y) { return y[0]; },
                              .crossing = rodwake::integrate::Crossing::falling,
                              .terminal = true});
    return problem;
}

/// When impact `n` (from 1) happens: the first fall, then flights each shorter by the restitution.
double exact_time(int n) {
    const double fall = std::sqrt(2.0 * drop_height / gravity);
    double time = fall;
    for (int k = 1; k < n; ++k)
        time += 2.0 * fall * std::pow(restitution, k);
    return time;
}

} // namespace

int main() {
    using namespace rodwake::integrate;
    OdeOptions options;
    options.method = Method::adams;
    options.rtol = 1e-10;
    options.atol = 1e-12; // m and m/s

    double time = 0.0, height = drop_height, velocity = 0.0, error = 0.0;
    std::printf("impact  time [s]           speed [m/s]\n");
    for (int n = 1; n <= impacts; ++n) {
        // The solve ends at the floor; this output time is only the latest one.
        const double output_times[] = {time + 10.0};
        const Solution solution = solve(flight(time, height, velocity), options, output_times);
        if (solution.status.outcome != Outcome::stopped_at_event) {
            std::fprintf(stderr, "no impact: %s\n", solution.status.message().c_str());
            return 1;
        }
        time = solution.final_time;
        height = 0.0; // the root is exact to rounding; take the floor itself
        velocity = -restitution * solution.final_state[1];
        error = std::max(error, std::abs(time / exact_time(n) - 1.0));
        std::printf("%-7d %.15f  %.15f\n", n, time, -solution.final_state[1]);
    }
    std::printf("true error %.2g (relative, worst impact)\n", error);
}
