// Time of the granular simulator: a step of the whole bed, with and without two rods, what the parts of a
// step of larger beds take a bead, and its vector loops for each instruction set of this machine. The bed:
// 1549 beads in a box of 78 radii, shaken at Gamma = 7 for 0.1 s before; larger ones as dense.
//
//   build/release/bench/bench_dem --benchmark_min_time=0.5
//   build/release/bench/bench_dem --benchmark_filter=bed
//
// Elastic spheres are for edmd_peers.py.

#include "granular/bodies.hpp"
#include "granular/kernels.hpp"
#include "granular/pair_finder.hpp"
#include "rodwake/granular/simulation.hpp"
#include "rodwake/granular/start.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <hwy/highway.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace rodwake::granular;
using benchmark::Counter;

constexpr std::int64_t period = 50; // steps: every phase of the plates counts alike
constexpr std::int64_t warm_up = 20 * period;

GranularProblem bed(std::size_t rods) {
    GranularProblem problem;
    problem.beads = 1549;
    problem.steps = 1'000'000'000'000; // never reached
    for (std::size_t i = 0; i < rods; ++i) {
        RodSpec rod;
        rod.position = {20.0 * problem.bead_radius,
                        (31.5 + 15.0 * static_cast<double>(i)) * problem.bead_radius};
        problem.rods.push_back(rod);
    }
    return problem;
}

Simulation shaken(const GranularProblem& problem) {
    Simulation simulation(problem, make_start(problem, 0));
    simulation.advance(warm_up);
    return simulation;
}

Counter seconds_per(double things) {
    return Counter(things, Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void step(benchmark::State& state, std::size_t rods) {
    Simulation simulation = shaken(bed(rods));
    for (auto _ : state)
        simulation.advance(period);
    if (simulation.failure())
        state.SkipWithError(simulation.failure()->message.c_str());
    state.counters["s_per_step"] = seconds_per(static_cast<double>(period));
    state.counters["inner_pairs"] = static_cast<double>(simulation.cost().inner_pairs);
    state.counters["outer_pairs"] = static_cast<double>(simulation.cost().outer_pairs);
}

GranularProblem large_bed(std::size_t beads, double phi_b) {
    GranularProblem problem = bed(0);
    const double a = problem.bead_radius;
    problem.beads = beads;
    problem.box = std::sqrt(static_cast<double>(beads) * std::numbers::pi * a * a / phi_b);
    return problem;
}

/// Smooth elastic spheres between plates that stand still, without gravity: what event-driven codes do. In a
/// step the rms speed of a component takes a sphere 0.005 radii, which gives about as many collisions a
/// sphere and step as a shaken bed has.
void elastic(benchmark::State& state, std::size_t beads, double phi_b) {
    GranularProblem problem = large_bed(beads, phi_b);
    problem.gravity = problem.plates.gamma = 0.0;
    for (Surface* surface : {&problem.contacts.bead_bead, &problem.contacts.bead_plate})
        *surface = {0.0, 1.0};
    problem.start_speed = 0.005 * problem.bead_radius / problem.time_step;
    Simulation simulation = shaken(problem);
    const Counters before = simulation.tallies();
    for (auto _ : state)
        simulation.advance(period);
    if (simulation.failure())
        state.SkipWithError(simulation.failure()->message.c_str());
    const auto rate = [](std::int64_t things) {
        return Counter(static_cast<double>(things), Counter::kIsRate);
    };
    const Counters& now = simulation.tallies();
    state.counters["collisions"] = rate(now.bead_bead - before.bead_bead);
    state.counters["bounces"] = rate(now.bead_plate - before.bead_plate);
    state.counters["a_step"] =
        static_cast<double>(now.bead_bead - before.bead_bead) /
        (static_cast<double>(simulation.step() - warm_up) * static_cast<double>(beads));
}

/// A step, and its parts one after the other, s a bead.
void parts(benchmark::State& state, std::size_t beads) {
    Simulation simulation = shaken(large_bed(beads, 0.8));
    for (auto _ : state)
        simulation.advance(period);
    const StepTimes times = simulation.advance_timed(4 * period);
    if (simulation.failure())
        state.SkipWithError(simulation.failure()->message.c_str());
    state.counters["s_per_bead"] = seconds_per(static_cast<double>(period) * static_cast<double>(beads));
    const double bead_steps = static_cast<double>(times.steps) * static_cast<double>(beads);
    for (const auto& [name, part] :
         {std::pair{"flight", times.flight}, {"search", times.search}, {"impulses", times.impulses}})
        state.counters[name] = part / bead_steps;
}

/// The instruction set that the vector loops use while this lives.
class OnTarget {
public:
    explicit OnTarget(std::int64_t target) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(target);
    }
    ~OnTarget() {
        hwy::SetSupportedTargetsForTest(0);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    }
    OnTarget(const OnTarget&) = delete;
    OnTarget& operator=(const OnTarget&) = delete;
};

Bodies shaken_bodies() {
    const GranularProblem problem = bed(0);
    return make_bodies(problem, shaken(problem).state());
}

/// Flight alone, no bead reaches a plate. Steps are so short that the beads stay where they are however often
/// this runs.
void fly(benchmark::State& state, std::int64_t target) {
    Bodies bodies = shaken_bodies();
    const OnTarget on(target);
    BodyRange velocities = BodyRange::empty();
    std::vector<std::uint32_t> out;
    for (auto _ : state) {
        drift(bodies.position.data(), bodies.velocity.data(), 0, bodies.beads, {1e-15, 9.81, -1.0, 1.0},
              velocities, out);
        benchmark::ClobberMemory();
    }
    if (!out.empty())
        state.SkipWithError("a bead left the space between the plates");
    state.counters["s_per_bead"] = seconds_per(static_cast<double>(bodies.beads));
}

/// Pairs nearer in the plane than the sum of radii + skin, and room for the answer.
struct Near {
    Bodies bodies = shaken_bodies();
    rodwake::PeriodicBox box = bed(0).box;
    PairList list;
    std::vector<std::uint32_t> found;

    explicit Near(double skin) {
        rodwake::ThreadPool team(1);
        near_pairs(bodies, box, skin * bodies.bead_radius, team, list);
        found.resize(list.size() + 8);
    }
};

void count_pairs(benchmark::State& state, const PairList& list, std::size_t found) {
    state.counters["s_per_pair"] = seconds_per(static_cast<double>(list.size()));
    state.counters["pairs"] = static_cast<double>(list.size());
    state.counters["found"] = static_cast<double>(found);
}

/// Over a list as short as the inner one is.
void overlap(benchmark::State& state, std::int64_t target) {
    Near near(0.1);
    const OnTarget on(target);
    std::size_t found = 0;
    for (auto _ : state) {
        found = overlapping(near.bodies.position.data(), near.list, 0, near.list.size(), near.box,
                            near.found.data());
        benchmark::ClobberMemory();
    }
    count_pairs(state, near.list, found);
}

/// Over the outer list, with an allowance as in a run.
void reach(benchmark::State& state, std::int64_t target) {
    Near near(1.0);
    const OnTarget on(target);
    const double allowance = 0.1 * near.bodies.bead_radius;
    std::size_t found = 0;
    for (auto _ : state) {
        found = within_reach(near.bodies.position.data(), near.list, 0, near.list.size(), near.box, allowance,
                             near.found.data());
        benchmark::ClobberMemory();
    }
    count_pairs(state, near.list, found);
}

std::string name_of(std::int64_t target) {
    const OnTarget on(target);
    return vector_target();
}

void register_all() {
    benchmark::RegisterBenchmark("step/no rods", step, 0);
    benchmark::RegisterBenchmark("step/two rods", step, 2);
    for (const std::size_t beads : {1549, 15'000, 100'000, 1'000'000})
        benchmark::RegisterBenchmark(fmt::format("bed/{}", beads).c_str(), parts, beads);
    for (const std::size_t beads : {1372, 16'384, 108'000})
        for (const double phi_b : {0.5, 0.7, 0.8})
            benchmark::RegisterBenchmark(fmt::format("elastic/{}/{}", beads, phi_b).c_str(), elastic, beads,
                                         phi_b);
    std::set<std::string> names;
    const std::int64_t all = hwy::SupportedTargets();
    for (std::int64_t left = all; left != 0; left &= left - 1) {
        const std::int64_t target = left & -left;
        const std::string name = name_of(target);
        if (!names.insert(name).second)
            continue; // built for none of its own: it takes the loops of another
        benchmark::RegisterBenchmark(("drift/" + name).c_str(), fly, target);
        benchmark::RegisterBenchmark(("overlapping/" + name).c_str(), overlap, target);
        benchmark::RegisterBenchmark(("within_reach/" + name).c_str(), reach, target);
    }
}

} // namespace

int main(int argc, char** argv) {
    register_all();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
