// The calls of bench/python_calls.py from C++, timed here so that both sides can be run in turns in one
// process: a library of plain functions that Python loads. Each returns seconds.

#include "rodwake/elastic/wake_kernel.hpp"
#include "rodwake/rods/simulate.hpp"

#include <chrono>
#include <cstdlib>
#include <vector>

namespace {

using namespace rodwake;

template<class Work>
double seconds(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

extern "C" {

/// The strain of one rod at n points in a batch, into memory of the caller (3 n numbers).
double strain_into(const double* x, const double* y, std::size_t n, double eta, double xi, double* out) {
    return seconds([&] {
        const elastic::Source rod{};
        elastic::WakeKernel({eta, xi}).strain({&rod, 1}, {{x, n}, {y, n}},
                                              {{out, n}, {out + n, n}, {out + 2 * n, n}});
    });
}

/// The same into vectors made for it.
double strain_anew(const double* x, const double* y, std::size_t n, double eta, double xi) {
    return seconds([&] {
        std::vector<double> xx(n), xy(n), yy(n);
        const elastic::Source rod{};
        elastic::WakeKernel({eta, xi}).strain({&rod, 1}, {{x, n}, {y, n}}, {xx, xy, yy});
    });
}

/// The pair of scenes/pair.toml to contact, `runs` times; seconds of one.
double pair(long runs) {
    return seconds([&] {
               for (long run = 0; run < runs; ++run) {
                   rods::RodProblem problem{
                       elastic::Medium{1.0, 1.0}, {.kappa = 0.5}, {{0, 2.5, 0}, {0, -2.5, 0}}, 60.0, {}, 0.1};
                   rods::RodOptions options;
                   options.ode.method = rods::suitable_method(problem);
                   if (rods::simulate(problem, options).outcome.ending != Ending::contact)
                       std::abort();
               }
           }) /
           static_cast<double>(runs);
}
}
