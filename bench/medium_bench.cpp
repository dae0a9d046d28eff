// Time of a step of rods in a medium that remembers, by modes, rods and threads, by sums and on the mesh:
// three steps of the method and twelve evaluations of all rods, as an accepted step takes them
// (models/medium/step_control.hpp). And of the steady fields of many rods, with which a run starts.
//
//   build/release/bench/bench_medium --benchmark_min_time=0.5

#include "medium/step_control.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

namespace {

using namespace rodwake;
using namespace rodwake::medium;

/// All over the box.
std::vector<double> poses_of(std::size_t rods, double box) {
    std::vector<double> poses;
    for (std::size_t a = 0; a < rods; ++a) {
        const double along = static_cast<double>(a) / static_cast<double>(rods);
        poses.insert(poses.end(), {box * along, box * std::fmod(7.3 * along, 1.0), 6.0 * along});
    }
    return poses;
}

constexpr elastic::Medium elastic_medium{1.0, 1.0};
constexpr rods::Couplings couplings{1.0, 0.0, 0.0};

/// Arguments: modes, rods, threads, one field for all, mesh, inertia in hundredths.
DynamicMedium medium_of(const benchmark::State& state) {
    return {.box = static_cast<double>(state.range(0)) / 2.4,
            .force_width = 1.1,
            .modes = static_cast<std::size_t>(state.range(0)),
            .self_field = state.range(3) == 1,
            .evaluation = state.range(4) == 1 ? Evaluation::mesh : Evaluation::sums,
            .inertia = 0.01 * static_cast<double>(state.range(5))};
}

void step(benchmark::State& state) {
    const auto rods = static_cast<std::size_t>(state.range(1));
    const DynamicMedium medium = medium_of(state);
    const auto method =
        make_step(elastic_medium, medium, couplings, rods, static_cast<std::size_t>(state.range(2)));
    StepControl control(*method, {1e-3, 1e-3}, method->start(poses_of(rods, medium.box)), 0.0, 1e-3);
    long failures = 0;
    for (auto _ : state)
        control.advance(1e-3, 1e9, failures);
    if (failures > 0)
        state.SkipWithError("a step was rejected: the time is not that of steps");
}

void start(benchmark::State& state) {
    const auto rods = static_cast<std::size_t>(state.range(1));
    const DynamicMedium medium = medium_of(state);
    const auto method =
        make_step(elastic_medium, medium, couplings, rods, static_cast<std::size_t>(state.range(2)));
    for (auto _ : state)
        benchmark::DoNotOptimize(method->start(poses_of(rods, medium.box)));
}

const std::vector<std::string> names{"modes", "rods", "threads", "self", "mesh", "inertia"};

BENCHMARK(step)
    ->ArgNames(names)
    ->ArgsProduct({{48, 96, 192, 384}, {2}, {1}, {0}, {0}, {0}})
    ->ArgsProduct({{96}, {8, 32}, {1}, {0}, {0}, {0}})
    ->ArgsProduct({{96}, {2, 32}, {2}, {0}, {0}, {0}})
    ->ArgsProduct({{96}, {2, 4, 8, 16, 32, 128}, {1}, {1}, {0, 1}, {0}}) // where the mesh becomes faster
    ->ArgsProduct({{96, 384}, {100, 1000, 10000}, {1}, {0}, {1}, {0}})
    ->ArgsProduct({{1024}, {100, 10000}, {1, 2}, {0}, {1}, {0}})
    ->ArgsProduct({{96}, {2}, {1}, {0}, {0}, {10}})
    ->ArgsProduct({{384}, {1000}, {1}, {1}, {1}, {0, 10}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

BENCHMARK(start)
    ->ArgNames(names)
    ->ArgsProduct({{384, 1024}, {10000}, {1}, {0}, {1}, {0}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
