// One right-hand side of many rods against their number, with and without far wakes left out, and what that
// changes; finding the closest pair and the step limit. Prints the rows of docs/validation_rods.md ("Many
// rods").

#include "rodwake/core/rng.hpp"
#include "rodwake/rods/simulate.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numbers>

using namespace rodwake;

namespace {

constexpr double spacing = 2.3; // f/mu: N rods in a square of spacing sqrt(N), as in scenes/crowd.toml

std::vector<double> random_rods(std::size_t rods) {
    RandomStream random(1);
    const double side = spacing * std::sqrt(static_cast<double>(rods));
    std::vector<double> y;
    for (std::size_t a = 0; a < rods; ++a) {
        const double x = random.uniform(0.0, side);
        y.insert(y.end(),
                 {x, random.uniform(0.0, side), random.uniform(-std::numbers::pi, std::numbers::pi)});
    }
    return y;
}

/// Milliseconds of processor time, which other programs hardly change; the shortest of some rounds.
template<class Work>
double time_of(const Work& work) {
    double best = HUGE_VAL, total = 0.0;
    for (int round = 0; round < 20 && (round < 2 || total < 2.0); ++round) {
        const std::clock_t start = std::clock();
        work();
        const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        best = std::min(best, seconds);
        total += seconds;
    }
    return 1e3 * best;
}

struct Rates {
    std::vector<double> ydot;
    double milliseconds;
};

Rates rates(const std::vector<double>& y, const rods::WakeSums& sums) {
    const rods::Couplings couplings{.kappa = 5.0};
    const rods::RodModel model(elastic::exact_field({1.0, 1.0}, {}, rods::sum_options(couplings, sums)),
                               couplings, y.size() / 3);
    Rates found{std::vector<double>(y.size()), 0.0};
    found.milliseconds = time_of([&] { model.rhs(y, found.ydot); });
    return found;
}

double largest_change(const Rates& kept, const Rates& all) {
    double largest = 0.0;
    for (std::size_t k = 2; k < all.ydot.size(); k += 3)
        largest = std::max(largest, std::abs(kept.ydot[k] - all.ydot[k]));
    return largest;
}

} // namespace

int main() {
    std::printf("N | all pairs, ms | single precision, ms | tolerance: ms, largest change of a turning rate "
                "... | closest pair, ms | step limit, ms\n");
    for (const std::size_t n : {100U, 300U, 1000U, 3000U, 10000U}) {
        const auto y = random_rods(n);
        const Rates all = rates(y, {});
        const Rates single = rates(y, {elastic::Accuracy::single});
        std::printf("%zu | %.3g | %.3g |", n, all.milliseconds, single.milliseconds);
        for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
            const Rates kept = rates(y, {.turning_tolerance = tolerance});
            std::printf(" %g: %.3g, %.1e;", tolerance, kept.milliseconds, largest_change(kept, all));
        }
        const double closest = time_of([&] { benchmark::DoNotOptimize(rods::closest_pair(y)); });
        const double limit = time_of([&] { benchmark::DoNotOptimize(rods::encounter_step(y)); });
        std::printf(" | %.3g | %.3g\n", closest, limit);
    }
}
