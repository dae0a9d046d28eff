// What a point of a scan costs beside its integration: its values made a problem, and
// its way through the queue into the ledger and out to a table.
//
//   build/release/bench/bench_scan --benchmark_min_time=0.5

#include "rodwake/app/scan_problem.hpp"
#include "rodwake/scan/run.hpp"
#include "rodwake/scene/read.hpp"

#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>

namespace {

using namespace rodwake;

const std::string text = R"(schema = 1
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 1.0
[[rods]]
position = [0.0, 0.0]
[[rods]]
position = [0.0, -4.0]
heading = "90 deg"
[rods_run]
t_end = 60.0
contact_distance = 0.1
[scan]
[[scan.axes]]
key = "coupling.kappa"
from = 0.1
to = 100.0
spacing = "log"
count = 512
[[scan.axes]]
key = "rods.1.position.0"
from = -6.0
to = 6.0
count = 512
)";

app::ScanPlan plan() { return app::plan_scan(scene::parse_scene(text, "bench"), {}); }

void per_point(benchmark::State& state, double points) {
    state.counters["s_per_point"] = benchmark::Counter(points, benchmark::Counter::kIsIterationInvariantRate |
                                                                   benchmark::Counter::kInvert);
}

void problem_of_a_point(benchmark::State& state) {
    const app::ScanPlan scan = plan();
    const scan::PointList points(scan.design);
    app::PointProblem problems(scan);
    std::int64_t id = 0;
    for (auto _ : state) {
        const rods::RodProblem& problem = problems.at(points[id++ % points.size()]);
        benchmark::DoNotOptimize(app::rod_options(problems.run(), problem));
    }
}

/// All that a point yields, at once.
void pretend(std::span<const scan::Point> points, std::span<scan::Result> results) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        results[i].point = points[i];
        results[i].outcome = static_cast<std::int32_t>(points[i].id % 4);
        results[i].values.fill(1.0 / static_cast<double>(points[i].id + 3));
    }
}

void ledger_and_dispatch(benchmark::State& state, std::size_t threads) {
    const app::ScanPlan scan = plan();
    const auto folder = std::filesystem::temp_directory_path() / "rodwake_bench_scan";
    for (auto _ : state) {
        std::filesystem::remove_all(folder);
        std::filesystem::create_directory(folder);
        scan::Ledger ledger(folder / "ledger.sqlite", {scan.description, scan.design.axes, scan.columns});
        scan::run(scan.design, ledger, scan::on_threads(pretend, threads, nullptr), {});
        ledger.sync();
    }
    std::filesystem::remove_all(folder);
    per_point(state, static_cast<double>(scan::size(scan.design)));
}

} // namespace

BENCHMARK(problem_of_a_point);
BENCHMARK_CAPTURE(ledger_and_dispatch, one_thread, 1)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(ledger_and_dispatch, two_threads, 2)->Unit(benchmark::kMillisecond)->UseRealTime();
