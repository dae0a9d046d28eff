// Time per point of the field of one rod, beside the closed form written straight from the paper with Boost's
// Bessel functions (which overflows far behind the rod and cancels near it: compare the speed, not the
// digits).
//
//   build/release/bench/bench_field --benchmark_min_time=0.5

#include "plain_field.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/field.hpp"

#include <benchmark/benchmark.h>
#include <cmath>
#include <numbers>
#include <vector>

namespace {

using rodwake::RandomStream;
using namespace rodwake::elastic;

constexpr Medium medium = plain_medium;

using FieldPoints = std::vector<Place>;

constexpr int points = 4096; // fits the first cache, far beyond what a branch predictor remembers

/// Time per point in seconds: the table prints 58.3n for 58.3 ns.
void per_point(benchmark::State& state) {
    using benchmark::Counter;
    state.counters["s_per_point"] = Counter(points, Counter::kIsIterationInvariantRate | Counter::kInvert);
}

FieldPoints near_points() { // r/xi from 1e-3 to 1
    RandomStream random(1);
    FieldPoints set;
    for (int k = 0; k < points; ++k) {
        const double r = random.log_uniform(1e-3, 1.0), angle = random.uniform(0.0, 2.0 * std::numbers::pi);
        set.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
    return set;
}

FieldPoints box(double left, double right, double half_height) {
    RandomStream random(2);
    FieldPoints set;
    for (int k = 0; k < points; ++k)
        set.push_back({random.uniform(left, right), random.uniform(-half_height, half_height)});
    return set;
}

FieldPoints mid_points() { return box(-5.0, 5.0, 5.0); }
FieldPoints wake_points() { return box(-1e3, -10.0, 30.0); }

using Formula = double (*)(Place);

void run_plain(benchmark::State& state, Formula formula, FieldPoints (*make)()) {
    const FieldPoints set = make();
    for (auto _ : state)
        for (const Place& p : set)
            benchmark::DoNotOptimize(formula(p));
    per_point(state);
}

void run_field(benchmark::State& state, FieldRequest request, FieldPoints (*make)()) {
    const FieldPoints set = make();
    const Field field(medium);
    for (auto _ : state)
        for (const Place& p : set)
            benchmark::DoNotOptimize(field.at(p.x, p.y, request));
    per_point(state);
}

constexpr FieldRequest displacement{.displacement = true}, strain{.strain = true},
    polar{.strain = true, .polar = true}, gradients{.strain = true, .gradients = true};

#define ON_EACH_SET(run, label, what)                                                                        \
    BENCHMARK_CAPTURE(run, label / near, what, near_points);                                                 \
    BENCHMARK_CAPTURE(run, label / mid, what, mid_points);                                                   \
    BENCHMARK_CAPTURE(run, label / wake, what, wake_points)

ON_EACH_SET(run_field, displacement, displacement);
ON_EACH_SET(run_field, strain, strain);
ON_EACH_SET(run_field, strain + polar, polar);
ON_EACH_SET(run_field, strain + gradients, gradients);
ON_EACH_SET(run_plain, displacement, plain_displacement<Promotion>);
ON_EACH_SET(run_plain, displacement / double, plain_displacement<NoPromotion>);
ON_EACH_SET(run_plain, strain, plain_strain<Promotion>);
ON_EACH_SET(run_plain, strain / double, plain_strain<NoPromotion>);

} // namespace
