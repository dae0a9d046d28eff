// Strain of one source at many targets: the scalar field, the batched kernel at each accuracy, one point of
// it at a time, tables of the field, and the closed form in the Bessel functions of Boost and the GSL; all
// pairs of many rods; all in one run. Counter s_per_point: time a source and target. bench/kernel_peers.py
// makes a table of it.
//
//   build/release/bench/bench_kernel --benchmark_min_time=0.5

#include "elastic/geometry.hpp"
#include "instruction_set.hpp"
#include "plain_field.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/mutual_wakes.hpp"
#include "rodwake/elastic/plane_table.hpp"

#include <benchmark/benchmark.h>

#include <vector>

namespace {

using namespace rodwake::elastic;

constexpr std::size_t points = 4096; // fits the first cache, far beyond what a branch predictor remembers

struct Targets {
    std::vector<double> x, y;

    Targets() : x(points), y(points) { // within 5 of the rod, r/xi
        rodwake::RandomStream random(2);
        for (std::size_t k = 0; k < points; ++k) {
            x[k] = random.uniform(-5.0, 5.0);
            y[k] = random.uniform(-5.0, 5.0);
        }
    }
};

void per_point(benchmark::State& state) {
    using benchmark::Counter;
    state.counters["s_per_point"] =
        Counter(static_cast<double>(points), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

/// Every point by itself.
template<class At>
void each(benchmark::State& state, const At& at) {
    const Targets targets;
    for (auto _ : state)
        for (std::size_t k = 0; k < points; ++k)
            benchmark::DoNotOptimize(at(targets.x[k], targets.y[k]));
    per_point(state);
}

void scalar_field(benchmark::State& state) {
    const Field field(plain_medium);
    each(state, [&](double x, double y) { return field.at(x, y, {.strain = true}).strain; });
}

void scalar_strain(benchmark::State& state) {
    const Field field(plain_medium);
    each(state, [&](double x, double y) { return field.strain(x, y); });
}

/// One point of a table of that tolerance; making it takes seconds, outside the measurement.
void table(benchmark::State& state, double tolerance) {
    const auto made = std::make_shared<const PlaneTable>(make_plane_table(plain_medium.eta, tolerance));
    const auto wake = table_field(made, plain_medium)->wake(0.0);
    each(state, [&](double x, double y) { return wake->at(x, y, {.strain = true}).strain; });
}

/// By the closed form alone, as Field::at does it where the faster route is not as accurate.
void scalar_closed_form(benchmark::State& state) {
    const Field field(plain_medium);
    each(state, [&](double x, double y) {
        return FieldInternals::by_potentials(field, x, y, {.strain = true}).strain;
    });
}

void boost_formula(benchmark::State& state) {
    each(state, [](double x, double y) { return plain_strain<Promotion>({x, y}); });
}

void boost_formula_in_double(benchmark::State& state) {
    each(state, [](double x, double y) { return plain_strain<NoPromotion>({x, y}); });
}

#ifdef RODWAKE_BENCH_GSL
void gsl_formula(benchmark::State& state) {
    each(state, [](double x, double y) { return plain_strain<Gsl>({x, y}); });
}
#endif

void kernel_one_point(benchmark::State& state) {
    const WakeKernel kernel(plain_medium);
    each(state, [&](double x, double y) { return kernel.strain({}, x, y); });
}

struct Sums {
    std::vector<double> part[7];

    Sums() {
        for (auto& one : part)
            one.resize(points);
    }
    StrainSums strain() { return {part[0], part[1], part[2]}; }
    PolarSums polar() { return {part[3], part[4], part[5], part[6]}; }
};

void kernel_batch(benchmark::State& state, Accuracy accuracy) {
    const WakeKernel kernel(plain_medium, accuracy);
    const Targets targets;
    const Source source;
    Sums sums;
    for (auto _ : state)
        kernel.strain({&source, 1}, {targets.x, targets.y}, sums.strain());
    per_point(state);
    state.SetLabel(wake_kernel_target());
}

void kernel_batch_polar(benchmark::State& state) {
    const WakeKernel kernel(plain_medium);
    const Targets targets;
    const Source source;
    Sums sums;
    for (auto _ : state)
        kernel.strain_and_polar({&source, 1}, {targets.x, targets.y}, sums.strain(), sums.polar());
    per_point(state);
    state.SetLabel(wake_kernel_target());
}

/// All pairs of rods at one in (3 xi)^2, one thread; with a tolerance, far wakes are left out. Counter share:
/// of the fields that were worked out.
void all_pairs(benchmark::State& state, Accuracy accuracy, double tolerance) {
    rodwake::RandomStream random(3);
    const auto rods = static_cast<std::size_t>(state.range(0));
    const double side = 3.0 * std::sqrt(static_cast<double>(rods));
    std::vector<Source> sources(rods);
    for (Source& one : sources)
        one = {random.uniform(0.0, side), random.uniform(0.0, side), random.uniform(0.0, 6.3)};
    std::vector<double> xx(rods), xy(rods), yy(rods);
    const MutualWakes wakes(plain_medium, {.accuracy = accuracy, .strain_tolerance = tolerance});
    std::size_t done = 0;
    for (auto _ : state)
        done = wakes.strain(sources, {xx, xy, yy});
    state.counters["share"] = static_cast<double>(done) / static_cast<double>(rods * (rods - 1));
}

BENCHMARK_CAPTURE(all_pairs, full, Accuracy::full, 0.0)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(all_pairs, fine, Accuracy::fine, 0.0)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(all_pairs, single, Accuracy::single, 0.0)
    ->Arg(1000)
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(all_pairs, full_skipping, Accuracy::full, 1e-3)
    ->Arg(1000)
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(all_pairs, fine_skipping, Accuracy::fine, 1e-3)
    ->Arg(1000)
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(all_pairs, single_skipping, Accuracy::single, 1e-3)
    ->Arg(1000)
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(scalar_field);
BENCHMARK(scalar_strain);
BENCHMARK(scalar_closed_form);
BENCHMARK_CAPTURE(kernel_batch, full, Accuracy::full);
BENCHMARK_CAPTURE(kernel_batch, fine, Accuracy::fine);
BENCHMARK_CAPTURE(kernel_batch, single, Accuracy::single);
BENCHMARK(kernel_batch_polar);
BENCHMARK(kernel_one_point);
BENCHMARK_CAPTURE(table, 1e-4, 1e-4);
BENCHMARK_CAPTURE(table, 1e-6, 1e-6);
BENCHMARK_CAPTURE(table, 1e-8, 1e-8);
BENCHMARK(boost_formula);
BENCHMARK(boost_formula_in_double);
#ifdef RODWAKE_BENCH_GSL
BENCHMARK(gsl_formula);
#endif

} // namespace
