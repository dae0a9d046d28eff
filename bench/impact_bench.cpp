// Time per impact: without coupling (spheres), planar rod (closed pieces), rod in space and general inverse
// mass (slip path curved, followed by Taylor series). Friction as in the experiment, and strong.
//
//   build/release/bench/bench_impact --benchmark_min_time=0.5

#include "rodwake/core/rng.hpp"
#include "rodwake/granular/impact.hpp"

#include <Eigen/Dense>
#include <benchmark/benchmark.h>
#include <vector>

namespace {

using namespace rodwake;
using namespace rodwake::granular;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Case {
    Matrix3d inverse_mass;
    Vector3d velocity;
};
using Cases = std::vector<Case>;

constexpr int impacts = 4096; // far beyond what a branch predictor remembers

Vector3d approach(RandomStream& random) {
    const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0);
    return {x, y, -random.uniform()};
}

Matrix3d rotation(RandomStream& random) {
    const Vector3d axis = approach(random).normalized();
    return Eigen::AngleAxisd(random.uniform(0.0, 6.28), axis).toRotationMatrix();
}

/// 1/m - [c] I^-1 [c] at the end of a rod 9 times as long as it is thick, axis at `frame`'s first column.
Matrix3d rod(const Matrix3d& frame) {
    const Vector3d arm = 4.0 * frame.col(0) - 0.5 * Vector3d::UnitZ();
    const Matrix3d inertia = frame * Vector3d(0.15, 7.0, 7.0).asDiagonal() * frame.transpose();
    Matrix3d cross;
    cross << 0.0, -arm.z(), arm.y(), arm.z(), 0.0, -arm.x(), -arm.y(), arm.x(), 0.0;
    return Matrix3d::Identity() - cross * inertia.inverse() * cross;
}

template<class Make>
Cases made(Make make) {
    RandomStream random(1);
    Cases cases;
    for (int k = 0; k < impacts; ++k)
        cases.push_back(make(random));
    return cases;
}

Cases spheres() {
    return made([](RandomStream& random) {
        return Case{Vector3d(3.5, 3.5, 1.0).asDiagonal(), approach(random)};
    });
}

Cases planar_rods() {
    return made([](RandomStream& random) {
        Matrix3d k = rod(Eigen::AngleAxisd(random.uniform(-0.3, 0.3), Vector3d::UnitY()).toRotationMatrix());
        k(0, 1) = k(1, 0) = k(1, 2) = k(2, 1) = 0.0;
        return Case{k, approach(random).cwiseProduct(Vector3d(1.0, 0.0, 1.0))};
    });
}

Cases rods() {
    return made([](RandomStream& random) { return Case{rod(rotation(random)), approach(random)}; });
}

Cases general() {
    return made([](RandomStream& random) {
        const Matrix3d turn = rotation(random);
        const Vector3d axes(1.0, random.log_uniform(0.01, 1.0), random.log_uniform(0.01, 1.0));
        return Case{turn * axes.asDiagonal() * turn.transpose(), approach(random)};
    });
}

template<class Law>
void run(benchmark::State& state, const Cases& cases, Law law) {
    using benchmark::Counter;
    for (auto _ : state)
        for (const Case& c : cases)
            benchmark::DoNotOptimize(law(c));
    state.counters["s_per_impact"] = Counter(impacts, Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void one_shot(benchmark::State& state) {
    run(state, spheres(), [](const Case& c) {
        return uncoupled_impact(c.inverse_mass(0, 0), c.inverse_mass(2, 2), c.velocity, {0.05, 0.3});
    });
}

void stronge(benchmark::State& state, Cases (*make)(), double friction) {
    const Surface surface{friction, 0.3};
    run(state, make(),
        [surface](const Case& c) { return stronge_impact(c.inverse_mass, c.velocity, surface); });
}

BENCHMARK(one_shot);
BENCHMARK_CAPTURE(stronge, sphere, spheres, 0.05);
BENCHMARK_CAPTURE(stronge, planar rod, planar_rods, 0.03);
BENCHMARK_CAPTURE(stronge, rod / mu 0.03, rods, 0.03);
BENCHMARK_CAPTURE(stronge, rod / mu 0.5, rods, 0.5);
BENCHMARK_CAPTURE(stronge, general / mu 0.03, general, 0.03);
BENCHMARK_CAPTURE(stronge, general / mu 0.5, general, 0.5);

} // namespace
