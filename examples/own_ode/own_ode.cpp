// An equation of your own, without any rods: a pendulum that swings far, and the times at which it passes the
// lowest point. The solver finds each as an event; elliptic integrals say when it really happens.
//
//   theta'' = -(g/l) sin theta,   theta(0) = theta0,   theta'(0) = 0
//   theta = 0 at t = (2 n - 1) K(sin(theta0/2)) sqrt(l/g),   n = 1, 2, ...,  K: complete elliptic integral

#include <rodwake/integrate/ode.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

int main() {
    using namespace rodwake::integrate;
    constexpr double g = 9.81, l = 1.0; // m/s^2, m
    constexpr double start = 2.5;       // rad, from the lowest point: far beyond small angles

    // What: y[0] = theta, y[1] = theta'.
    OdeProblem pendulum;
    pendulum.initial_state = {start, 0.0};
    pendulum.rhs = [](double, State y, std::span<double> ydot) {
        ydot[0] = y[1];
        ydot[1] = -g / l * std::sin(y[0]);
    };
    // An event is a root of a function of time and state. Terminal ones end the solve; this one is only
    // noted.
    pendulum.events.push_back({.name = "lowest point", .value = [](double, State y) { return y[0]; }});

    // How.
    OdeOptions options;
    options.method = Method::adams;
    options.rtol = 1e-10;
    options.atol = 1e-12;

    const double output_times[] = {10.0}; // the last one is the end; the steps do not depend on the others
    const Solution solution = solve(pendulum, options, output_times);
    if (!solution.status.ok()) {
        std::fprintf(stderr, "%s\n", solution.status.message().c_str());
        return 1;
    }

    const double quarter = std::comp_ellint_1(std::sin(start / 2.0)) * std::sqrt(l / g);
    double error = 0.0;
    std::printf("pass  time [s]\n");
    for (std::size_t n = 0; n < solution.hits.size(); ++n) {
        const double time = solution.hits[n].time, exact = static_cast<double>(2 * n + 1) * quarter;
        std::printf("%-5zu %.13f\n", n + 1, time);
        error = std::max(error, std::abs(time / exact - 1.0));
    }
    std::printf("%zu passes in %ld steps\n", solution.hits.size(), solution.statistics.steps);
    std::printf("true error   %.2g (relative, worst pass)\n", error);
}
