#include "scan_noise.hpp"

#include "theory/noise_runs.hpp"

#include <algorithm>
#include <array>

namespace rodwake::app {

namespace {

void put(const ScanPlan& plan, const CaptureNumbers& capture, scan::Result& result) {
    const auto numbers = field_values(capture);
    std::ranges::copy(numbers, result.values.begin() + static_cast<std::ptrdiff_t>(
                                                           plan.columns.observables.size() - numbers.size()));
}

/// The first of equals.
Ending most_frequent(const rods::NoiseSums& sums) {
    std::array<long, 4> counts{};
    for (const rods::NoisyEnd& end : sums.ends)
        ++counts[static_cast<std::size_t>(end.ending)];
    return static_cast<Ending>(std::ranges::max_element(counts) - counts.begin());
}

} // namespace

bool evaluate_noisy(const ScanPlan& plan, const rods::RodProblem& problem, const rods::RodOptions& options,
                    const NoisePlan& noise, const OutputUnits& units, scan::Result& result) {
    rods::RodOptions each = options;
    each.criteria = rods::noisy_criteria;
    rods::NoiseSums sums = rods::no_runs(problem);
    if (!run_wanted(problem, each, noise, 1, sums))
        return false;
    if (!sums.failure.empty()) {
        result.status = scan::Status::failed;
        result.set_cause("a run with noise: " + sums.failure);
        return true;
    }
    Leader leader(problem);
    if (problem.rods.size() == 2)
        each.ode.on_step = [&](const integrate::Step& step) { leader.add(step.state); };
    const rods::RodResult first = rods::simulate(problem, each, noise.noise, 0);
    if (first.solution.status.termination == integrate::Termination::interrupted)
        return false;
    EncounterEnd end = end_of(problem, first, leader.ahead());
    end.ending = most_frequent(sums);
    const scan::Proportion capture = captured(sums, problem.rods.size());
    const auto [low, high] = capture.wilson(capture_quantile);
    put(plan, {capture.value(), low, high, static_cast<double>(sums.ends.size())}, result);
    store(end, plan, units, result);
    return true;
}

void store_certain_capture(const ScanPlan& plan, Ending ending, scan::Result& result) {
    const double share = ending == Ending::contact || ending == Ending::pursuit ? 1.0 : 0.0;
    if (plan.base.noise)
        put(plan, {share, share, share, 1.0}, result);
}

} // namespace rodwake::app
