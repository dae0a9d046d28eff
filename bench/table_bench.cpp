// Tables of the wake on the plane: their errors, sizes and the time of a strain beside that of the exact
// field. Prints the rows of studies/reports/elastic.md ("Tables of the field").

#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/plane_table.hpp"

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>

using namespace rodwake;
using namespace rodwake::elastic;

namespace {

constexpr double tolerances[] = {1e-3, 1e-4, 1e-6, 1e-8, 1e-10};

std::vector<Vector> places() {
    RandomStream random(1);
    std::vector<Vector> all;
    for (int i = 0; i < 4096; ++i) {
        const double r = random.log_uniform(0.05, 20.0),
                     angle = random.uniform(-std::numbers::pi, std::numbers::pi);
        all.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
    return all;
}

/// Nanoseconds of one strain, the shortest of forty rounds.
double time_of(const Wake& wake, const std::vector<Vector>& at) {
    double best = HUGE_VAL;
    for (int round = 0; round < 40; ++round) {
        const auto start = std::chrono::steady_clock::now();
        for (const Vector& p : at)
            benchmark::DoNotOptimize(wake.at(p.x, p.y, {.strain = true}));
        best =
            std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return 1e9 * best / static_cast<double>(at.size());
}

double megabytes(const PlaneTable& table) {
    return 8e-6 * static_cast<double>(table.strain.coefficients.size() + table.gradient.coefficients.size());
}

} // namespace

int main() {
    const auto at = places();
    std::printf("tolerance | eta: error of strain, gradient; MB ... | degree | eta = 1: table, exact, ns\n");
    for (const double tolerance : tolerances) {
        std::printf("%g |", tolerance);
        for (const double eta : {0.1, 100.0, 1.0}) {
            const auto table = std::make_shared<const PlaneTable>(make_plane_table(eta, tolerance, 2));
            std::printf(" %g: %.1e, %.1e; %.0f |", eta, table->strain_error, table->gradient_error,
                        megabytes(*table));
            if (eta == 1.0)
                std::printf(" %d | %.0f, %.0f\n", table->degree,
                            time_of(*table_field(table, {eta, 1.0})->wake(0.0), at),
                            time_of(*exact_field({eta, 1.0})->wake(0.0), at));
        }
    }
}
