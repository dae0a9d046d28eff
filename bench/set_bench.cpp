// Time to set one value of a typed scene by a compiled setter, and a variant by one and by text.
//
//   build/release/bench/bench_set --benchmark_min_time=0.5

#include "rodwake/scene/read.hpp"
#include "rodwake/scene/set.hpp"

#include <benchmark/benchmark.h>
#include <string>
#include <vector>

namespace {

using namespace rodwake::scene;

const std::string text = R"(schema = 1
[medium]
eta = 1.0
alpha = 0.5
[coupling]
kappa = 0.5
[[rods]]
position = [0.0, 2.5]
[[rods]]
position = [0.0, -2.5]
[rods_run]
t_end = 30.0
contact_distance = 0.1
[granular]
phi_b = 0.78
box = "78 a"
duration = "10 s"
[[granular.rods]]
position = ["20 a", "46.5 a"]
)";

/// Sets `key` to two values in turn.
void set_value(benchmark::State& state, const std::string& key, double first, double second) {
    Scene scene = parse_scene(text, "bench");
    const ValueSetter setter = compile_setter(scene, key);
    bool odd = false;
    for (auto _ : state) {
        if (setter.set(scene, odd ? first : second))
            state.SkipWithError("refused");
        odd = !odd;
        benchmark::ClobberMemory();
    }
}

void check_whole(benchmark::State& state) {
    const Scene scene = parse_scene(text, "bench");
    for (auto _ : state)
        benchmark::DoNotOptimize(validate(scene));
}

/// What a value costs as text: the scene written, changed and read.
void set_text(benchmark::State& state) {
    const Scene scene = parse_scene(text, "bench");
    const std::vector<std::string> settings{"coupling.kappa=0.25"};
    for (auto _ : state)
        benchmark::DoNotOptimize(parse_scene(to_toml(scene), "bench", settings));
}

void variant(benchmark::State& state) {
    const Scene scene = parse_scene(text, "bench");
    const Variant changed{"v", "", {"coupling.kappa=0.25"}};
    for (auto _ : state)
        benchmark::DoNotOptimize(apply_variant(scene, changed));
}

} // namespace

BENCHMARK_CAPTURE(set_value, kappa, "coupling.kappa", 0.5, 0.25);
BENCHMARK_CAPTURE(set_value, alpha, "medium.alpha", 0.5, 0.25);
BENCHMARK_CAPTURE(set_value, position, "rods.1.position.0", 0.5, 0.25);
BENCHMARK_CAPTURE(set_value, heading, "rods.1.heading", 0.5, 0.25);
BENCHMARK_CAPTURE(set_value, phi_b, "granular.phi_b", 0.78, 0.77);
BENCHMARK_CAPTURE(set_value, rtol, "rods_run.rtol", 1e-8, 1e-9);
BENCHMARK_CAPTURE(set_value, t_end, "rods_run.t_end", 30.0, 31.0);
BENCHMARK(check_whole);
BENCHMARK(variant);
BENCHMARK(set_text);
