// Two rods walk side by side through an elastic medium. Each turns in the strain that the other leaves in its
// wake, and so they meet. This is scenes/pair.toml from C++.
//
// Problem, options and result are three types: say what is to be solved, then how, then read what came out.

#include <rodwake/rods/simulate.hpp>

#include <cmath>
#include <cstdio>

int main() {
    using namespace rodwake;

    // What: lengths in f/mu, times in f/(mu v0), so a rod walks one unit of length in one unit of time.
    rods::RodProblem problem;
    problem.medium = elastic::Medium{.eta = 1.0, .xi = 1.0}; // xi = 1/alpha
    problem.couplings.kappa = 0.5;                           // turns a rod to the extensional axis
    problem.rods = {{.x = 0.0, .y = 2.5, .heading = 0.0}, {.x = 0.0, .y = -2.5, .heading = 0.0}};
    problem.t_end = 60.0;
    problem.contact_distance = 0.1; // the run ends there

    // How: a tolerance, and Adams' method, whose right-hand sides are few.
    rods::RodOptions options;
    options.ode.method = integrate::Method::adams;
    options.ode.rtol = 1e-10;
    options.ode.atol = 1e-12;

    const rods::RodResult result = rods::simulate(problem, options);

    // A solve that fails is a value, not an exception: whoever scans a thousand pairs goes on to the next.
    if (!result.solution.status.ok()) {
        std::fprintf(stderr, "%s\n", result.solution.status.message().c_str());
        return 1;
    }

    const rods::RodOutcome& outcome = result.outcome;
    std::printf("outcome      %s\n", rodwake::to_string(outcome.ending).c_str());
    std::printf("time         %.15g f/(mu v0)\n", outcome.time);
    std::printf("separation   %.15g f/mu\n", outcome.min_separation);
    std::printf("steps        %ld\n", result.solution.statistics.steps);

    // The contact time is known to 17 digits from an integration in 34-digit arithmetic.
    const double exact = 40.595264757446582;
    std::printf("true error   %.2g (relative)\n", std::abs(outcome.time / exact - 1.0));
}
