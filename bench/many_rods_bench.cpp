// One right-hand side of many rods against their number, pair by pair and with far wakes on meshes, and what
// that changes; finding the closest pair and the step limit. Prints the rows of studies/reports/rods.md
// ("Many rods"); with a number, errors in as many crowds of 10^4 rods; with "bodies", what their contacts
// cost.

#include "rodwake/core/rng.hpp"
#include "rodwake/rods/simulate.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <string_view>

using namespace rodwake;

namespace {

constexpr double spacing = 2.3; // f/mu: N rods in a square of spacing sqrt(N), as in scenes/crowd.toml

std::vector<double> random_rods(std::size_t rods, std::uint64_t seed) {
    RandomStream random(seed);
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
double time_of(const Work& work, int rounds = 20) {
    double best = HUGE_VAL, total = 0.0;
    for (int round = 0; round < rounds && (round < 2 || total < 2.0); ++round) {
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
    double milliseconds = 0.0;
};

Rates rates(const std::vector<double>& y, const rods::InteractionOptions& sums, int rounds = 20) {
    const rods::Couplings couplings{.kappa = 5.0};
    const rods::RodModel model(elastic::exact_field({1.0, 1.0}, {}, rods::sum_options(couplings, sums)),
                               couplings, y.size() / 3);
    Rates found{std::vector<double>(y.size()), 0.0};
    found.milliseconds = time_of([&] { model.rhs(y, found.ydot); }, rounds);
    return found;
}

double largest_change(const Rates& kept, const Rates& all) {
    double largest = 0.0;
    for (std::size_t k = 2; k < all.ydot.size(); k += 3)
        largest = std::max(largest, std::abs(kept.ydot[k] - all.ydot[k]));
    return largest;
}

/// Largest change, and root mean square, over `crowds` crowds of 10^4 rods.
void print_errors(int crowds) {
    std::printf("tolerance | rods | largest change of a turning rate | root mean square\n");
    constexpr std::size_t n = 10000;
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
        double largest = 0.0, squares = 0.0;
        for (int seed = 1; seed <= crowds; ++seed) {
            const auto y = random_rods(n, static_cast<std::uint64_t>(seed));
            const Rates all = rates(y, {}, 1), far = rates(y, {.turning_tolerance = tolerance}, 1);
            largest = std::max(largest, largest_change(far, all));
            for (std::size_t k = 2; k < all.ydot.size(); k += 3)
                squares += (far.ydot[k] - all.ydot[k]) * (far.ydot[k] - all.ydot[k]);
        }
        std::printf("%g | %zu | %.1e | %.1e\n", tolerance, n * static_cast<std::size_t>(crowds), largest,
                    std::sqrt(squares / static_cast<double>(n * static_cast<std::size_t>(crowds))));
    }
}

void print_row(std::size_t n) {
    const auto y = random_rods(n, 1);
    std::printf("%zu |", n);
    Rates all;
    if (n <= 30000) {
        all = rates(y, {});
        const Rates single = rates(y, {elastic::Accuracy::single});
        std::printf(" %.3g | %.3g |", all.milliseconds, single.milliseconds);
    } else {
        std::printf(" | |");
    }
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
        const Rates far = rates(y, {.turning_tolerance = tolerance});
        std::printf(" %.3g", far.milliseconds);
        if (!all.ydot.empty())
            std::printf(" (%.0e)", largest_change(far, all));
        std::printf(" |");
    }
    const double closest = time_of([&] { benchmark::DoNotOptimize(rods::closest_pair(y)); });
    const double limit = time_of([&] { benchmark::DoNotOptimize(rods::encounter_step(y)); });
    std::printf(" %.3g | %.3g\n", closest, limit);
    std::fflush(stdout);
}

/// Rods of the default body at 0.2 a length squared, with as many overlaps as random places have, at far
/// wakes of 1e-5; and two rods that touch by the number of its discs.
void print_bodies() {
    std::printf("rods | wakes, ms | contacts, ms | ratio of both to wakes | closest, ms | step limit, ms\n");
    for (const std::size_t n : {300U, 1000U, 3000U, 10000U}) {
        rods::RodBodies bodies;
        bodies.shapes = {rods::BodyShape{}};
        const rods::BodyForces forces(bodies, n, std::nullopt);
        auto y = random_rods(n, 1);
        for (std::size_t k = 0; k < y.size(); ++k)
            y[k] *= k % 3 == 2 ? 1.0 : bodies.of(0).length / std::sqrt(0.2) / spacing;
        const Rates wakes = rates(y, {.turning_tolerance = 1e-5});
        std::vector<double> ydot(y.size());
        const double contacts = time_of([&] { forces.add_rates(y, ydot); });
        std::printf("%zu | %.3g | %.3g | %.2f | %.3g | %.3g\n", n, wakes.milliseconds, contacts,
                    (wakes.milliseconds + contacts) / wakes.milliseconds,
                    time_of([&] { benchmark::DoNotOptimize(forces.closest(y)); }),
                    time_of([&] { benchmark::DoNotOptimize(forces.step_limit(y, 0.5)); }));
    }
    std::printf("\ndiscs of each of two rods | contacts, ns | gap, ns\n");
    const std::vector<double> touching = {0.0, 0.0, 0.0, 0.8, 0.1, 0.9}; // tip into side
    for (const std::size_t discs : {6U, 40U, 300U, 1000U}) {
        const rods::BodyForces forces({{rods::BodyShape{discs, 1.25, 0.3, 0.2}}}, 2, std::nullopt);
        std::vector<double> ydot(6);
        constexpr int often = 100;
        const auto repeat = [&](const auto& work) {
            return 1e6 / often * time_of([&] {
                       for (int k = 0; k < often; ++k)
                           work();
                   });
        };
        std::printf("%zu | %.0f | %.0f\n", discs, repeat([&] { forces.add_rates(touching, ydot); }),
                    repeat([&] { benchmark::DoNotOptimize(forces.contact(touching, 0, 1)); }));
    }
}

} // namespace

int main(int count, char** words) {
    if (count > 1 && std::string_view(words[1]) == "bodies") {
        print_bodies();
        return 0;
    }
    if (count > 1) {
        print_errors(std::atoi(words[1]));
        return 0;
    }
    std::printf(
        "N | all pairs, ms | single precision, ms | turning_tolerance 1e-3, ms (largest change) | 1e-6 | "
        "1e-9 | closest pair, ms | step limit, ms\n");
    for (const std::size_t n : {100U, 300U, 1000U, 3000U, 10000U, 30000U, 100000U})
        print_row(n);
}
