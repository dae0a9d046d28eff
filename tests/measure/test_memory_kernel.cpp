// The memory kernel of beads whose kernel is known: bound with and without much drag, and a Maxwell element.

#include "catch2/catch.hpp"
#include "known_motion.hpp"
#include "rodwake/measure/memory_kernel.hpp"

using namespace rodwake;
using namespace rodwake::measure;
using synthetic::KnownMotion;

namespace {

struct Set {
    const char* name;
    KnownMotion motion;
    double interval;
};

const Set sets[] = {{"underdamped", {20.0, 6.5e-4, 0.0}, 0.01},
                    {"overdamped", {1000.0, 6.5e-4, 0.0}, 0.05},
                    {"Maxwell", {100.0, 6.5e-4, 1.0}, 0.02}};

MicrorheologyResult measured(const Set& set, std::size_t runs, std::size_t beads, std::size_t frames,
                             std::uint64_t seed) {
    std::vector<MicrorheologyAccumulator> all;
    for (std::size_t run = 0; run < runs; ++run)
        all.push_back(synthetic::run_of(set.motion, beads, frames, set.interval, seed + run));
    return reduce(all);
}

/// With the T_xy that the beads were given; like the displacements it lacks the mean's share, 1/beads.
MemoryKernel kernel_of(const MicrorheologyResult& result, std::size_t beads, double drag_rate) {
    const double temperature = KnownMotion::temperature * (1.0 - 1.0 / static_cast<double>(beads));
    return memory_kernel(result.spectrum, KnownMotion::mass, temperature, Estimate{drag_rate, 0.0, 1});
}

struct Agreement {
    double points = 0.0, within_one = 0.0, within_two = 0.0;
    double worst = 0.0; ///< share of k~ where its error is below 1 %
    double precise = 0.0;
};

/// In the range of s that the result states, against a kernel so many times the true one.
Agreement compare(const Set& set, const MicrorheologyResult& result, const MemoryKernel& k,
                  double times = 1.0) {
    Agreement a;
    for (std::size_t i = 0; i < k.s.size(); ++i) {
        if (!result.spectrum.low || k.s[i] < *result.spectrum.low || k.s[i] > *result.spectrum.high)
            continue;
        const double truth = times * set.motion.kernel(k.s[i]), off = std::abs(k.kernel[i] - truth);
        const double bias = k.bias[i];
        a.points += 1.0;
        a.within_one += off < k.kernel_error[i] + bias;
        a.within_two += off < 2.0 * k.kernel_error[i] + bias;
        if (k.kernel_error[i] + bias < 0.01 * truth) {
            a.precise += 1.0;
            a.worst = std::max(a.worst, off / truth);
        }
    }
    return a;
}

} // namespace

TEST_CASE("the kernel of beads that are bound, or held by a Maxwell element, is the true one, and no other",
          "[memory_kernel]") {
    for (const Set& set : sets) {
        const MicrorheologyResult result = measured(set, 4, 400, 2000, 50);
        const MemoryKernel k = kernel_of(result, 400, set.motion.drag), kept = kernel_of(result, 400, 0.0);
        const Agreement a = compare(set, result, k);
        CAPTURE(set.name, a.points, a.within_one, a.within_two, a.precise, a.worst, *result.spectrum.low,
                *result.spectrum.high);
        CHECK(a.points >= 24.0); // two decades
        CHECK(a.within_two > 0.9 * a.points);
        CHECK(a.precise >= 8.0);
        CHECK(a.worst < 0.02);

        const Agreement wrong = compare(set, result, k, 1.1), dragged = compare(set, result, kept);
        CAPTURE(wrong.within_two, dragged.within_two);
        CHECK(wrong.within_two < 0.6 * wrong.points);
        CHECK(dragged.within_two < 0.6 * dragged.points);
    }
}

TEST_CASE("errors of the kernel cover: two thirds of the points are within one", "[.][long]") {
    for (const std::size_t runs : {1, 6}) { // errors over groups of beads, over runs
        Agreement all;
        for (const Set& set : sets)
            for (std::uint64_t seed = 0; seed < 12; ++seed) {
                const MicrorheologyResult result = measured(set, runs, 64, 400, 1000 + 100 * seed);
                MemoryKernel k = kernel_of(result, 64, set.motion.drag);
                k.bias.assign(k.bias.size(), 0.0);
                const Agreement a = compare(set, result, k);
                all.points += a.points;
                all.within_one += a.within_one;
                all.within_two += a.within_two;
            }
        CAPTURE(runs, all.points, all.within_one / all.points, all.within_two / all.points);
        // Points of a curve go together, some 3 to 4 are independent: 36 curves tell a share of 0.68 to
        // 0.045. Student's t lowers it to 0.64 for 6 runs; the bias of up to 2 % is left out of account here.
        CHECK(std::abs(all.within_one / all.points - 0.66) < 0.14);
        CHECK(all.within_two / all.points > 0.85);
    }
}

TEST_CASE("inertia and drag are taken off, the drag's error is added", "[memory_kernel]") {
    StiffnessSpectrum spectrum;
    spectrum.s = {2.0, 10.0};
    spectrum.value = {5.0, 50.0};
    spectrum.error = {0.3, 0.4};
    spectrum.bias = {0.1, 0.2};
    const double mass = 0.25, T = 2.0; // 4 m T = 2
    const MemoryKernel k = memory_kernel(spectrum, mass, T, Estimate{4.0, 0.2, 3});
    CHECK(k.total == std::vector<double>{10.0, 100.0});
    CHECK(k.bias == std::vector<double>{0.2, 0.4});
    CHECK(k.with_drag == std::vector<double>{9.0, 75.0}); // less m s^2
    CHECK(k.kernel == std::vector<double>{7.0, 65.0});    // less m 4 s
    CHECK(k.kernel_error[0] == Approx(std::hypot(0.6, 0.1)).epsilon(1e-15));
    CHECK(k.kernel_error[1] == Approx(std::hypot(0.8, 0.5)).epsilon(1e-15));
}

TEST_CASE("without a drag there is no kernel, without its error no error", "[memory_kernel]") {
    StiffnessSpectrum spectrum;
    spectrum.s = spectrum.value = spectrum.error = spectrum.bias = {1.0};
    const MemoryKernel none = memory_kernel(spectrum, 1.0, 1.0, std::nullopt);
    CHECK(none.with_drag[0] == 3.0);
    CHECK(none.total_error[0] == 4.0);
    CHECK(std::isnan(none.kernel[0]));
    CHECK(std::isnan(none.kernel_error[0]));
    const MemoryKernel unknown = memory_kernel(spectrum, 1.0, 1.0, Estimate{1.0, unknown_error, 1});
    CHECK(unknown.kernel[0] == 2.0);
    CHECK(std::isnan(unknown.kernel_error[0]));
}
