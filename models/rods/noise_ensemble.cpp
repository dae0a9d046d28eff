#include "rodwake/rods/noise_ensemble.hpp"

#include "rodwake/core/parallel.hpp"
#include "rodwake/rods/classify_outcome.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::rods {

NoiseSums no_runs(const RodProblem& problem) {
    const std::size_t times = output_times(problem).size(), size = times * problem.rods.size();
    const std::vector<double> none(size);
    return {{}, {}, std::vector<double>(times), none, none, none, none};
}

void add(NoiseSums& sums, const RodProblem& problem, const RodResult& run) {
    const RodOutcome& outcome = run.outcome;
    const bool failed = !run.solution.status.ok();
    if (failed && sums.failure.empty())
        sums.failure = run.solution.status.message();
    sums.ends.push_back({failed, outcome.ending, outcome.time, outcome.min_separation, outcome.pair.first,
                         outcome.pair.second});
    const std::size_t rods = problem.rods.size();
    for (std::size_t t = 0; t < run.solution.states.size(); ++t) {
        sums.reached[t] += 1.0;
        for (std::size_t a = 0; a < rods; ++a) {
            const Pose now = pose(run.solution.states[t], a), start = problem.rods[a];
            const double dx = now.x - start.x, dy = now.y - start.y, square = dx * dx + dy * dy;
            const double cosine = std::cos(now.heading - start.heading);
            sums.square[t * rods + a] += square;
            sums.square_squares[t * rods + a] += square * square;
            sums.cosine[t * rods + a] += cosine;
            sums.cosine_squares[t * rods + a] += cosine * cosine;
        }
    }
}

namespace {

NoiseMeans means_of(const std::vector<double>& reached, const std::vector<double>& sums,
                    const std::vector<double>& squares) {
    NoiseMeans means;
    const std::size_t rods = sums.size() / reached.size();
    for (std::size_t k = 0; k < sums.size(); ++k) {
        const double n = reached[k / rods], value = sums[k] / n; // of no run NaN
        const double spread = std::max(0.0, squares[k] / n - value * value);
        means.values.push_back(value);
        means.errors.push_back(n > 1.0 ? std::sqrt(spread / (n - 1.0)) : std::nan(""));
    }
    return means;
}

} // namespace

NoiseMeans mean_square_displacement(const NoiseSums& sums) {
    return means_of(sums.reached, sums.square, sums.square_squares);
}

NoiseMeans heading_correlation(const NoiseSums& sums) {
    return means_of(sums.reached, sums.cosine, sums.cosine_squares);
}

CaptureCount count_captures(std::span<const NoisyEnd> ends, std::size_t rods) {
    CaptureCount counted;
    for (const NoisyEnd& end : ends)
        if (!end.failed && rods > 1) {
            ++counted.of;
            counted.count += is_capture(end.ending) ? 1 : 0;
        }
    return counted;
}

bool run_ensemble(const RodProblem& problem, const RodOptions& options, const Noise& noise,
                  std::uint32_t runs, std::size_t threads, NoiseSums& sums,
                  const std::function<void(const NoiseSums&)>& added) {
    RodOptions each = options;
    each.ode.on_step = nullptr;
    RodProblem item = problem; // of many runs at a time, each on a thread of its own
    item.sums.threads = threads > 1 ? 1 : item.sums.threads;
    constexpr std::size_t few = 8; // for each thread
    while (sums.ends.size() < runs) {
        const std::size_t done = sums.ends.size(), batch = std::min<std::size_t>(few * threads, runs - done);
        std::vector<RodResult> results(batch);
        parallel_for(batch, threads, [&](std::size_t i) {
            results[i] = simulate(item, each, noise, static_cast<std::uint32_t>(done + i));
        });
        for (const RodResult& result : results) {
            if (result.solution.status.termination == integrate::Termination::interrupted)
                return false;
            add(sums, problem, result);
        }
        if (added)
            added(sums);
    }
    return true;
}

} // namespace rodwake::rods
