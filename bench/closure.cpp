// What the quasi-static closure does to a pair side by side: the same encounter with steady wakes on the
// plane, in the periodic box, with the steady wakes of Gaussian forces (the closure in the dynamic medium's
// own terms), and with memory. Prints a Markdown table of contact times, or of turning up to the end where
// there is no contact.
//
//   build/release/bench/bench_closure

#include "medium/exponential_step.hpp"
#include "rodwake/medium/simulate.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace rodwake;

constexpr double box = 40.0, end = 30.0, contact = 1.0, rtol = 1e-7;
constexpr medium::DynamicMedium dynamics{.box = box, .force_width = 0.5, .modes = 112};

rods::RodProblem problem(double kappa, double alpha) {
    rods::RodProblem p;
    p.medium = elastic::Medium{1.0, 1.0 / alpha};
    p.couplings.kappa = kappa;
    p.rods = {{0.0, 2.5, 0.0}, {0.0, -2.5, 0.0}};
    p.t_end = end;
    p.contact_distance = contact;
    return p;
}

rods::RodOptions options() {
    rods::RodOptions o;
    o.ode.method = integrate::Method::erk;
    o.ode.rtol = rtol;
    o.ode.atol = 0.01 * rtol;
    return o;
}

/// Steady wakes of the dynamic medium's forces: a right-hand side that makes the fields anew.
integrate::Solution steady_gaussian(rods::RodProblem p) {
    p.box = box;
    integrate::OdeProblem ode = rods::to_ode(p);
    const auto method =
        std::make_shared<medium::ExponentialStep>(*p.medium, dynamics, p.couplings, p.rods.size(), 1);
    ode.rhs = [method](double, integrate::State y, std::span<double> ydot) {
        const medium::Coupled steady = method->start({y.begin(), y.end()});
        method->rates(y, steady.fields, ydot);
    };
    ode.jacobian = nullptr;
    return integrate::solve(ode, options().ode, std::vector{end});
}

std::string told(const integrate::Solution& s) {
    char text[64];
    const bool met = s.status.termination == integrate::Termination::stopped_at_event;
    if (!s.status.ok())
        return s.status.flag;
    if (met)
        std::snprintf(text, sizeof text, "contact %.4g", s.final_time);
    else
        std::snprintf(text, sizeof text, "turned %.3g, %.3g", s.final_state[2], s.final_state[5]);
    return text;
}

} // namespace

int main() {
    std::puts("| alpha | kappa | steady, plane | steady, box | steady, Gaussian | memory "
              "|\n|---|---|---|---|---|---|");
    for (const double alpha : {0.1, 1.0, 10.0})
        for (const double kappa : {1.0, 10.0, 100.0}) {
            rods::RodProblem p = problem(kappa, alpha);
            const std::string plane = told(rods::simulate(p, options()).solution);
            p.box = box;
            const std::string periodic = told(rods::simulate(p, options()).solution);
            const std::string gaussian = told(steady_gaussian(p));
            const std::string memory = told(medium::simulate({p, dynamics}, options()).solution);
            std::printf("| %g | %g | %s | %s | %s | %s |\n", alpha, kappa, plane.c_str(), periodic.c_str(),
                        gaussian.c_str(), memory.c_str());
            std::fflush(stdout);
        }
}
