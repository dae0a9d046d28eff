// Trajectories of random pairs to contact or t = 60 (kappa 0.3 to 300 of both signs): the batch,
// rods::simulate with explicit Runge-Kutta, and boost::numeric::odeint's dopri5 on the scalar right-hand side
// with a look for contact after each step, all in one run. Counters: trajectories a second; the median error
// of the final state against a run at 1e-12, where both end alike. `plain` and `certified`: 2000 pairs with
// kappa up to the argument, without and with certificates; seconds a pair, and the shares that are verified
// and checked.

#include "instruction_set.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/rods/certificate.hpp"
#include "rodwake/rods/pair_batch.hpp"

#include <benchmark/benchmark.h>
#include <boost/numeric/odeint.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace {

using namespace rodwake;
using State = std::array<double, 6>;

constexpr double contact = 0.1, first_step = 1e-2;

template<class Kappa>
std::vector<rods::PairProblem> random_pairs(std::size_t count, const Kappa& kappa_of) {
    RandomStream random(7);
    const auto angle = [&] { return random.uniform(-std::numbers::pi, std::numbers::pi); };
    std::vector<rods::PairProblem> pairs;
    while (pairs.size() < count) {
        const double kappa = kappa_of(random);
        const rods::Pose other{random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0), angle()};
        if (std::hypot(other.x, other.y) > 0.2)
            pairs.push_back(
                {{1.0, 1.0}, {.kappa = kappa}, {rods::Pose{0.0, 0.0, angle()}, other}, 60.0, contact});
    }
    return pairs;
}

std::vector<rods::PairProblem> random_pairs(std::size_t count) {
    return random_pairs(count, [](RandomStream& random) {
        return random.log_uniform(0.3, 300.0) * (random.uniform() < 0.5 ? -1.0 : 1.0);
    });
}

struct End {
    double time;
    State state;
};

End end_of(const rods::RodResult& run) {
    End end{run.outcome.time, {}};
    std::copy_n(run.solution.final_state.begin(), 6, end.state.begin());
    return end;
}

rods::RodResult simulated(const rods::PairProblem& pair, double rtol) {
    rods::RodOptions options;
    options.ode.method = integrate::Method::erk;
    options.ode.rtol = rtol;
    options.ode.atol = 0.01 * rtol;
    return rods::simulate(to_rod_problem(pair), options);
}

End with_odeint(const rods::PairProblem& pair, double rtol) {
    namespace odeint = boost::numeric::odeint;
    const rods::RodModel model(elastic::exact_field(pair.medium), pair.couplings, 2);
    const std::vector<double> start = rods::to_state(pair.rods);
    State y{};
    std::copy_n(start.begin(), 6, y.begin());
    const auto rhs = [&](const State& at, State& rate, double) { model.rhs(at, rate); };
    auto stepper = odeint::make_controlled(rtol, rtol, odeint::runge_kutta_dopri5<State>());
    double t = 0.0, step = first_step;
    while (t < pair.t_end && std::hypot(y[0] - y[3], y[1] - y[4]) > contact) {
        step = std::min({step, pair.t_end - t, rods::encounter_step(y)});
        stepper.try_step(rhs, y, t, step);
    }
    return {t, y};
}

/// Median over the pairs of the largest difference from the truth.
double median_error(const std::vector<rods::PairProblem>& pairs, const std::vector<End>& ends) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < std::min<std::size_t>(pairs.size(), 300); ++i) {
        const End truth = end_of(simulated(pairs[i], 1e-12));
        double worst = std::abs(ends[i].time - truth.time);
        for (std::size_t k = 0; k < 6; ++k)
            worst = std::max(worst, std::abs(ends[i].state[k] - truth.state[k]));
        errors.push_back(worst);
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2), errors.end());
    return errors[errors.size() / 2];
}

void report(benchmark::State& state, const std::vector<rods::PairProblem>& pairs,
            const std::vector<End>& ends) {
    state.counters["a_second"] =
        benchmark::Counter(static_cast<double>(pairs.size()), benchmark::Counter::kIsIterationInvariantRate);
    state.counters["error"] = median_error(pairs, ends);
}

template<class Solve>
void one_by_one(benchmark::State& state, const Solve& solve) {
    const auto pairs = random_pairs(1000);
    std::vector<End> ends(pairs.size());
    for (auto _ : state)
        for (std::size_t i = 0; i < pairs.size(); ++i)
            ends[i] = solve(pairs[i]);
    report(state, pairs, ends);
}

double tolerance(const benchmark::State& state) {
    return std::pow(10.0, -static_cast<double>(state.range(0)));
}

void batch(benchmark::State& state) {
    const auto pairs = random_pairs(4000);
    const rods::PairOptions options{.rtol = tolerance(state), .atol = 0.01 * tolerance(state)};
    std::vector<rods::PairResult> results(pairs.size());
    for (auto _ : state)
        rods::simulate_pairs(pairs, options, results);
    std::vector<End> ends;
    for (const auto& result : results)
        ends.push_back({result.time, result.state});
    report(state, pairs, ends);
    state.counters["handed_over"] = static_cast<double>(
        std::count_if(results.begin(), results.end(), [](auto& r) { return r.handed_over(); }));
}

void simulate_erk(benchmark::State& state) {
    one_by_one(state, [&](const auto& pair) { return end_of(simulated(pair, tolerance(state))); });
}

void odeint_dopri5(benchmark::State& state) {
    one_by_one(state, [&](const auto& pair) { return with_odeint(pair, tolerance(state)); });
}

template<class Run>
void with_kappa(benchmark::State& state, const Run& run) {
    const double most = static_cast<double>(state.range(0));
    const auto pairs = random_pairs(2000, [&](RandomStream& random) { return random.uniform(-most, most); });
    std::vector<rods::PairResult> results(pairs.size());
    for (auto _ : state)
        run(pairs, rods::PairOptions{.rtol = 1e-7, .atol = 1e-9}, results);
    using Counter = benchmark::Counter;
    const auto count = static_cast<double>(pairs.size());
    state.counters["a_pair"] = Counter(count, Counter::kIsIterationInvariantRate | Counter::kInvert);
    const auto share = [&](Certificate certificate) {
        const auto has = [&](const rods::PairResult& one) { return one.certificate == certificate; };
        return static_cast<double>(std::ranges::count_if(results, has)) / count;
    };
    state.counters["verified"] = share(Certificate::verified);
    state.counters["checked"] = share(Certificate::checked);
}

void plain(benchmark::State& state) {
    with_kappa(state, [](const auto& pairs, const auto& options, auto& results) {
        rods::simulate_pairs(pairs, options, results);
    });
}

void certified(benchmark::State& state) {
    with_kappa(state, [](const auto& pairs, const auto& options, auto& results) {
        rods::simulate_certified(pairs, options, results);
    });
}

BENCHMARK(plain)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(certified)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(batch)->Arg(6)->Arg(9)->Unit(benchmark::kMillisecond);
BENCHMARK(simulate_erk)->Arg(6)->Arg(9)->Unit(benchmark::kMillisecond);
BENCHMARK(odeint_dopri5)->Arg(6)->Arg(9)->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
