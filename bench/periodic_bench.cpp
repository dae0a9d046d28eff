// Time per point of the field in a periodic box and of its derivatives by the medium, the place and the
// heading, and of building it anew, which a fit does for each trial medium and rods in a box at each step.
//
//   build/release/bench/bench_periodic --benchmark_min_time=0.5

#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/periodic.hpp"
#include "rodwake/elastic/periodic_table.hpp"

#include <benchmark/benchmark.h>
#include <cmath>
#include <vector>

namespace {

using rodwake::RandomStream;
using namespace rodwake::elastic;

/// Argument: L/xi in thousandths.
Medium medium(const benchmark::State& state) {
    return {.eta = 1.3, .xi = 1e3 / static_cast<double>(state.range(0))};
}

double heading(const benchmark::State& state) { return 0.1 * static_cast<double>(state.range(1)); }

void construct(benchmark::State& state) {
    for (auto _ : state)
        benchmark::DoNotOptimize(PeriodicField(medium(state), 1.0, heading(state)));
}

/// Places over the whole box.
template<class Evaluate>
void over_box(benchmark::State& state, Evaluate evaluate) {
    constexpr int points = 4096;
    RandomStream random(1);
    std::vector<Vector> set;
    for (int k = 0; k < points; ++k)
        set.push_back({random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)});
    const PeriodicField field(medium(state), 1.0, heading(state));
    for (auto _ : state)
        for (const Vector& p : set)
            benchmark::DoNotOptimize(evaluate(field, p));
    using benchmark::Counter;
    state.counters["s_per_point"] = Counter(points, Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void displacement(benchmark::State& state) {
    over_box(state, [](const PeriodicField& f, Vector p) { return f.at(p.x, p.y, {.displacement = true}); });
}

void strain(benchmark::State& state) {
    over_box(state, [](const PeriodicField& f, Vector p) { return f.at(p.x, p.y, {.strain = true}); });
}

void displacement_derivatives(benchmark::State& state) {
    over_box(state, [](const PeriodicField& f, Vector p) {
        return f.medium_derivatives(p.x, p.y, {.displacement = true});
    });
}

void gradients(benchmark::State& state) {
    over_box(state, [](const PeriodicField& f, Vector p) {
        return f.at(p.x, p.y, {.strain = true, .gradients = true});
    });
}

void heading_derivatives(benchmark::State& state) {
    over_box(state, [](const PeriodicField& f, Vector p) {
        return f.heading_derivative(p.x, p.y, {.strain = true});
    });
}

/// What a pair's right-hand side takes of the field: the strain of each rod at the other's place and of its
/// images at its own, at headings that are new each time.
template<class Strains>
void pair(benchmark::State& state, Strains strains) {
    double heading = 0.3;
    for (auto _ : state) {
        const Source a{0.1, 0.2, heading}, b{0.4, 0.35, -2.0 * heading};
        benchmark::DoNotOptimize(strains(a, b));
        benchmark::DoNotOptimize(strains(b, a));
        heading += 1e-4;
    }
}

void pair_by_field(benchmark::State& state) {
    pair(state, [&](const Source& a, const Source& b) {
        const PeriodicField field(medium(state), 1.0, a.heading);
        const Vector at = turned(Vector{b.x - a.x, b.y - a.y}, std::cos(a.heading), -std::sin(a.heading));
        return field.at(at.x, at.y, {.strain = true}).strain.xy +
               field.self_image_field({.strain = true}).strain.xy;
    });
}

void pair_by_table(benchmark::State& state) {
    const PeriodicTable table(medium(state), 1.0, 1e-8, 2);
    state.counters["error"] = table.error();
    state.counters["bytes"] = static_cast<double>(table.bytes());
    pair(state, [&](const Source& a, const Source& b) {
        return table.at(a, b.x, b.y, {.strain = true}).strain.xy +
               table.self_image_field(a.heading, {.strain = true}).strain.xy;
    });
}

void build_table(benchmark::State& state) {
    for (auto _ : state)
        benchmark::DoNotOptimize(PeriodicTable(medium(state), 1.0, 1e-8, 2));
}

void media(benchmark::internal::Benchmark* b) {
    for (const long turned : {0, 7})
        for (const long ratio : {1, 100, 1000, 5000, 20000, 100000, 1000000})
            b->Args({ratio, turned});
}

void tabulated(benchmark::internal::Benchmark* b) {
    for (const long ratio : {10, 1000, 5000, 10000, 25000, 50000})
        b->Args({ratio, 0});
}

BENCHMARK(construct)->Apply(media);
BENCHMARK(displacement)->Apply(media);
BENCHMARK(strain)->Apply(media);
BENCHMARK(displacement_derivatives)->Apply(media);
BENCHMARK(gradients)->Apply(media);
BENCHMARK(pair_by_field)->Apply(tabulated);
BENCHMARK(pair_by_table)->Apply(tabulated);
BENCHMARK(build_table)->Apply(tabulated)->UseRealTime();
BENCHMARK(heading_derivatives)->Apply(media);

} // namespace
