// Time of a step of rods in a medium that remembers, by modes, rods and threads: three steps of the method
// and eleven sums over the modes at each rod, as an accepted step takes them
// (models/medium/step_control.hpp).
//
//   build/release/bench/bench_medium --benchmark_min_time=0.5

#include "medium/step_control.hpp"

#include <benchmark/benchmark.h>

#include <cmath>

namespace {

using namespace rodwake;
using namespace rodwake::medium;

/// Arguments: modes, rods, threads, one field for all.
void step(benchmark::State& state) {
    const auto modes = static_cast<std::size_t>(state.range(0)),
               rods = static_cast<std::size_t>(state.range(1));
    const auto width = static_cast<double>(state.range(0)) / 2.4;
    const DynamicMedium medium{
        .box = width, .force_width = 1.1, .modes = modes, .self_field = state.range(3) == 1};
    ExponentialStep method({1.0, 1.0}, medium, {1.0, 0.0, 0.0}, rods,
                           static_cast<std::size_t>(state.range(2)));
    std::vector<double> poses;
    for (std::size_t a = 0; a < rods; ++a) {
        const double along = static_cast<double>(a) / static_cast<double>(rods);
        poses.insert(poses.end(), {width * along, width * std::fmod(7.3 * along, 1.0), 6.0 * along});
    }
    StepControl control(method, {1e-3, 1e-3}, method.start(poses), 0.0, 1e-3);
    long failures = 0;
    for (auto _ : state)
        control.advance(1e-3, 1e9, failures);
    if (failures > 0)
        state.SkipWithError("a step was rejected: the time is not that of steps");
}

BENCHMARK(step)
    ->ArgNames({"modes", "rods", "threads", "self"})
    ->ArgsProduct({{48, 96, 192, 384}, {2}, {1}, {0}})
    ->ArgsProduct({{96}, {8, 32}, {1}, {0}})
    ->ArgsProduct({{96}, {2, 32}, {2}, {0}})
    ->ArgsProduct({{96}, {32, 128}, {1}, {1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
