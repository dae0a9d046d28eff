// Time of a displacement map of the orthotropic medium and of its derivative by a constant, and of building
// what stays the same as the medium varies: 78 x 78 places in a box of 78 a, and 156 x 156 in one of 156 a.
//
//   build/release/bench/bench_anisotropic --benchmark_min_time=0.5

#include "rodwake/elastic/anisotropic.hpp"

#include <benchmark/benchmark.h>
#include <vector>

namespace {

using namespace rodwake::elastic;

constexpr OrthotropicMedium crystal{
    .c11 = 3.1, .c22 = 4.4, .c12 = 1.3, .c66 = 1.0, .zeta = 0.02, .rho = 0.03, .eta_s = 0.15};
constexpr RodSource source{1.0, -3.0, 9.0};

/// Argument: side of the box, bins of 1.
AnisotropicField field(const benchmark::State& state) {
    const auto side = static_cast<double>(state.range(0));
    std::vector<double> places;
    for (long k = 0; k < state.range(0); ++k)
        places.push_back(static_cast<double>(k) - 0.5 * side);
    return {{.lx = side, .ly = side, .speed = 1.7, .length = 11.25, .width = 1.0}, places, places};
}

void construct(benchmark::State& state) {
    for (auto _ : state)
        benchmark::DoNotOptimize(field(state));
}

void displacement(benchmark::State& state) {
    const AnisotropicField whole = field(state);
    for (auto _ : state)
        benchmark::DoNotOptimize(whole.displacement(crystal, source));
}

void derivative(benchmark::State& state) {
    const AnisotropicField whole = field(state);
    for (auto _ : state)
        benchmark::DoNotOptimize(whole.derivative(crystal, source, OrthotropicParameter::c66));
}

} // namespace

BENCHMARK(construct)->Arg(78)->Arg(156)->Unit(benchmark::kMillisecond);
BENCHMARK(displacement)->Arg(78)->Arg(156)->Unit(benchmark::kMillisecond);
BENCHMARK(derivative)->Arg(78)->Arg(156)->Unit(benchmark::kMillisecond);
