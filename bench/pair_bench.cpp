// A pair trajectory: rodwake's methods beside boost::numeric::odeint's dopri5 on the same right-hand side in
// the same run. Counters: right-hand sides per trajectory, and the largest error of the final state against a
// run at rtol 1e-13. odeint also runs at the loosest tolerance at which its error is no larger than that of
// rodwake's ERK ("as exact").
//
// All runs go to a fixed time, nine tenths of the way to contact, without event: what odeint can do.

#include "rodwake/rods/simulate.hpp"

#include <benchmark/benchmark.h>
#include <boost/numeric/odeint.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace {

using namespace rodwake;
using State = std::vector<double>;

constexpr double first_step = 1e-2; // of the explicit methods, the one rods::simulate takes

struct Encounter {
    const char* name;
    double kappa;
    std::vector<rods::Pose> start;
    double t_end;
};

const std::vector<Encounter> encounters = {
    {"parallel kappa 0.5", 0.5, {{0, 2.5, 0}, {0, -2.5, 0}}, 0.9 * 40.595264757},
    {"parallel kappa 100", 100.0, {{0, 2.5, 0}, {0, -2.5, 0}}, 0.9 * 5.917088399},
    {"perpendicular kappa 0.5", 0.5, {{0, 0, 0}, {1, -5, std::numbers::pi / 2}}, 54.0},
    {"perpendicular kappa 100", 100.0, {{0, 0, 0}, {1, -5, std::numbers::pi / 2}}, 5.0},
};

rods::RodProblem problem_of(const Encounter& encounter) {
    return {elastic::Medium{1.0, 1.0}, {.kappa = encounter.kappa}, encounter.start, encounter.t_end, {}, {}};
}

State final_state(const Encounter& encounter, integrate::Method method, double rtol, long& evaluations) {
    const rods::RodProblem problem = problem_of(encounter);
    integrate::OdeOptions options;
    options.method = method;
    options.rtol = rtol;
    options.atol = rtol;
    if (method == integrate::Method::erk)
        options.initial_step = first_step;
    const double end[] = {problem.t_end};
    const auto solution = integrate::solve(rods::to_ode(problem), options, end);
    evaluations = solution.statistics.rhs_evaluations;
    return solution.final_state;
}

State odeint_state(const Encounter& encounter, double tolerance, long& evaluations) {
    namespace odeint = boost::numeric::odeint;
    const rods::RodModel model(elastic::exact_field({1.0, 1.0}), {.kappa = encounter.kappa}, 2);
    State y = rods::to_state(encounter.start);
    evaluations = 0;
    const auto rhs = [&](const State& at, State& ydot, double) {
        ++evaluations;
        model.rhs(at, ydot);
    };
    const auto stepper = odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_dopri5<State>());
    odeint::integrate_adaptive(stepper, rhs, y, 0.0, encounter.t_end, first_step);
    return y;
}

double error_of(const Encounter& encounter, const State& y) {
    long ignored = 0;
    const State truth = final_state(encounter, integrate::Method::erk, 1e-13, ignored);
    double worst = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i)
        worst = std::max(worst, std::abs(y[i] - truth[i]));
    return worst;
}

/// Of odeint, eight to the decade.
double tolerance_as_exact(const Encounter& encounter, double tolerance) {
    long ignored = 0;
    const double wanted =
        error_of(encounter, final_state(encounter, integrate::Method::erk, tolerance, ignored));
    double found = 1e-3;
    while (error_of(encounter, odeint_state(encounter, found, ignored)) > wanted)
        found *= std::pow(10.0, -0.125);
    return found;
}

template<class Solve>
void measure(benchmark::State& state, const Encounter& encounter, Solve solve) {
    State y;
    long evaluations = 0;
    for (auto _ : state)
        benchmark::DoNotOptimize(y = solve(evaluations));
    state.counters["rhs"] = static_cast<double>(evaluations);
    state.counters["error"] = error_of(encounter, y);
}

void register_all() {
    for (const Encounter& encounter : encounters)
        for (const double tolerance : {1e-6, 1e-10}) {
            const std::string tail =
                std::string("/") + encounter.name + (tolerance > 1e-8 ? "/1e-6" : "/1e-10");
            for (const auto method :
                 {integrate::Method::erk, integrate::Method::adams, integrate::Method::bdf})
                benchmark::RegisterBenchmark(("rodwake " + integrate::to_string(method) + tail).c_str(),
                                             [&encounter, method, tolerance](benchmark::State& state) {
                                                 measure(state, encounter, [&](long& n) {
                                                     return final_state(encounter, method, tolerance, n);
                                                 });
                                             })
                    ->Unit(benchmark::kMicrosecond);
            const auto add_odeint = [&](const char* name, double its_tolerance) {
                benchmark::RegisterBenchmark((name + tail).c_str(), [&encounter,
                                                                     its_tolerance](benchmark::State& state) {
                    measure(state, encounter,
                            [&](long& n) { return odeint_state(encounter, its_tolerance, n); });
                })->Unit(benchmark::kMicrosecond);
            };
            add_odeint("odeint dopri5", tolerance);
            add_odeint("odeint dopri5 as exact", tolerance_as_exact(encounter, tolerance));
        }
}

} // namespace

int main(int argc, char** argv) {
    register_all();
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
