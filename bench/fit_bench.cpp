// One fit of a exp(-x/b) + c to 100 points, three parameters: the NLopt stage alone and with
// Levenberg-Marquardt after it.

#include "rodwake/core/rng.hpp"
#include "rodwake/fitting/report.hpp"

#include <benchmark/benchmark.h>

#include <cmath>

using namespace rodwake::fitting;

namespace {

Parameter parameter(const char* name, double start, Transform transform = Transform::linear) {
    Parameter p;
    p.name = name;
    p.start = start;
    p.transform = transform;
    return p;
}

Problem decay() {
    Problem problem;
    problem.parameters = {parameter("a", 1.0), parameter("b", 1.0, Transform::log), parameter("c", 0.1)};
    problem.residuals = 100;
    std::vector<double> x, y;
    rodwake::RandomStream random(1);
    for (int i = 0; i < 100; ++i) {
        x.push_back(0.05 * i);
        y.push_back(2.0 * std::exp(-x.back() / 1.5) + 0.5 + random.uniform(-0.1, 0.1));
    }
    problem.evaluate = [x, y](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                              Eigen::MatrixXd* jacobian) {
        for (Eigen::Index i = 0; i < 100; ++i) {
            const double e = std::exp(-x[i] / p[1]);
            r[i] = (p[0] * e + p[2] - y[i]) / 0.06;
            if (jacobian)
                jacobian->row(i) << e / 0.06, p[0] * e * x[i] / (p[1] * p[1]) / 0.06, 1.0 / 0.06;
        }
    };
    return problem;
}

void one_fit(benchmark::State& state, Algorithm algorithm, bool levenberg_marquardt) {
    const Problem problem = decay();
    Method method;
    method.algorithm = algorithm;
    method.levenberg_marquardt = levenberg_marquardt;
    long evaluations = 0;
    for (auto _ : state) {
        const Fit best = fit(problem, method);
        evaluations = best.evaluations;
        benchmark::DoNotOptimize(best.chi2);
    }
    state.counters["evaluations"] = static_cast<double>(evaluations);
}

void one_report(benchmark::State& state) {
    const Problem problem = decay();
    const Fit best = fit(problem, {});
    for (auto _ : state)
        benchmark::DoNotOptimize(report(problem, best).rank);
}

} // namespace

BENCHMARK_CAPTURE(one_fit, slsqp, Algorithm::slsqp, false);
BENCHMARK_CAPTURE(one_fit, slsqp_levenberg_marquardt, Algorithm::slsqp, true);
BENCHMARK_CAPTURE(one_fit, lbfgs_levenberg_marquardt, Algorithm::lbfgs, true);
BENCHMARK_CAPTURE(one_fit, bobyqa_levenberg_marquardt, Algorithm::bobyqa, true);
BENCHMARK(one_report);
