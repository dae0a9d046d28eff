#include "scan_parts.hpp"

#include "rodwake/app/scan_problem.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/certificate.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "rodwake/rods/pair_batch.hpp"
#include "rodwake/scan/lattice.hpp"
#include "scan_values.hpp"
#include "theory/rods_ensemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

namespace rodwake::app {

namespace {

using Clock = std::chrono::steady_clock;
using integrate::Method;
using integrate::Termination;

/// Writes the numbers of a capture, which are the last observables of a point.
void put_capture(const ScanPlan& plan, const CaptureNumbers& capture, scan::Result& result) {
    const auto numbers = field_values(capture);
    std::ranges::copy(numbers, result.values.begin() + static_cast<std::ptrdiff_t>(
                                                           plan.columns.observables.size() - numbers.size()));
}

/// Makes all runs of a point on this thread. The outcome is the most frequent ending, the numbers are those
/// of run 0 with CaptureNumbers behind them. Returns false if options.ode.stop_requested stopped it.
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
    FrontRodTracker leader(problem);
    if (problem.rods.size() == 2)
        each.ode.on_step = [&](const integrate::Step& step) { leader.add(step.state); };
    const rods::RodResult first = rods::simulate(problem, each, noise.noise, 0);
    if (first.solution.status.termination == integrate::Termination::interrupted)
        return false;
    EncounterEnd end = end_of(problem, first, leader.ahead());
    std::array<long, all_endings.size()> counts{};
    for (const rods::NoisyEnd& noisy : sums.ends)
        ++counts[static_cast<std::size_t>(noisy.ending)];
    end.ending =
        static_cast<Ending>(std::ranges::max_element(counts) - counts.begin()); // the first of equals
    const scan::Proportion capture = captured(sums, problem.rods.size());
    const auto [low, high] = capture.wilson(capture_quantile);
    put_capture(plan, {capture.value(), low, high, static_cast<double>(sums.ends.size())}, result);
    store(end, plan, units, result);
    return true;
}

/// Writes CaptureNumbers of a point that has a single outcome for certain. Does nothing without [noise].
void store_certain_capture(const ScanPlan& plan, Ending ending, scan::Result& result) {
    const double share = is_capture(ending) ? 1.0 : 0.0;
    if (plan.base.noise)
        put_capture(plan, {share, share, share, 1.0}, result);
}

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The ladder of retries: changes the options for the attempt after number `rung`. Returns false if none is
/// left.
bool next_rung(rods::RodOptions& options, int rung) {
    integrate::OdeOptions& ode = options.ode;
    switch (rung) {
    case 0:
        ode.max_steps *= 10;
        return true;
    case 1:
        ode.rtol = std::max(0.1 * ode.rtol, 1e-13);
        ode.atol *= 0.1;
        return true;
    case 2:
        ode.method = options.form == rods::Formulation::dae || ode.method != Method::bdf ? Method::bdf
                     : options.form == rods::Formulation::angle                          ? Method::adams
                                                                                         : Method::erk;
        return true;
    default:
        return false;
    }
}

/// Points go into a batch if the method is free and an explicit one suits them. A batch does not look at the
/// time before it is done, so that it must be short beside the limit.
bool suits_batch(const scene::RodsRun& run, const rods::RodOptions& options,
                 std::optional<double> time_limit) {
    constexpr double longest_in_batch = 0.1; // s, with a good margin
    return !run.method && run.form == rods::Formulation::angle && options.ode.method == Method::erk &&
           time_limit.value_or(HUGE_VAL) > longest_in_batch;
}

/// Near critical values rods circle for long, and are not stiff.
rods::PairOptions pair_options(const integrate::OdeOptions& ode, bool critical) {
    rods::PairOptions options{ode.rtol, ode.atol};
    options.max_attempts = std::min(critical ? 100'000 : options.max_attempts, ode.max_steps);
    return options;
}

} // namespace

rods::RodResult run_rods(const scene::RodsRun& run, const rods::RodProblem& problem,
                         const rods::RodOptions& options, bool critical) {
    const auto pair = rods::to_pair_problem(problem);
    if (!pair || !suits_batch(run, options, {}))
        return rods::simulate(problem, options);
    rods::PairOptions batch = pair_options(options.ode, critical);
    batch.criteria = options.criteria;
    double time = 0.0;
    std::vector<double> before = rods::to_state(problem.rods);
    if (options.ode.on_step)
        batch.on_step = [&](std::size_t, const rods::PairStep& step) {
            options.ode.on_step({time, step.time, before, step.state});
            time = step.time;
            before.assign(step.state.begin(), step.state.end());
        };
    rods::PairResult end;
    rods::simulate_pairs({&*pair, 1}, batch, {&end, 1});
    if (end.handed_over())
        return rods::simulate(problem, options);
    rods::RodResult result;
    result.outcome = rods::outcome_of(*pair, end, batch.criteria);
    result.solution.final_state.assign(end.state.begin(), end.state.end());
    result.solution.statistics.steps = end.steps;
    result.solution.statistics.rhs_evaluations = end.rhs_evaluations;
    if (options.ode.stop_requested && options.ode.stop_requested())
        result.solution.status.termination = Termination::interrupted;
    return result;
}

namespace {

/// Rods that are undecided go on from `state`, each time for as long as they have run, until their outcome is
/// decided or at the scene's limit. The last part of a run is the same share of its whole time. Returns how
/// the last solve ended.
integrate::Status decide(const rods::RodProblem& start, rods::RodOptions options, double limit,
                         std::vector<double> state, FrontRodTracker& leader, EncounterEnd& end,
                         const scene::RodsRun* batch = nullptr, bool critical = false) {
    const double steady_fraction = options.criteria.steady_fraction;
    if (start.rods.size() == 2)
        options.ode.on_step = [&](const integrate::Step& step) { leader.add(step.state); };
    integrate::Status status;
    while (end.ending == Ending::undecided && end.time < limit && status.ok()) {
        rods::RodProblem rest = start;
        for (std::size_t a = 0; a < rest.rods.size(); ++a)
            rest.rods[a] = rods::pose(state, a);
        rest.goes_on = true;
        rest.output_times.clear();
        rest.t_end = std::min(end.time, limit - end.time);
        options.criteria.steady_fraction =
            std::min(1.0, steady_fraction * (end.time + rest.t_end) / rest.t_end);
        rods::RodResult run =
            batch ? run_rods(*batch, rest, options, critical) : rods::simulate(rest, options);
        status = run.solution.status;
        if (!status.ok() || status.termination == Termination::interrupted)
            break;

        // Turns, times and closest approach add up over all parts of the run.
        const EncounterEnd before = end;
        for (std::size_t a = 0; a < before.turn.size(); ++a)
            run.outcome.turn[a] += before.turn[a];
        end = end_of(start, run, leader.ahead());
        end.time += before.time;
        if (before.min_separation <= end.min_separation) {
            end.min_separation = before.min_separation;
            end.min_separation_time = before.min_separation_time;
        } else
            end.min_separation_time += before.time;
        end.steps += before.steps;
        end.rhs_evaluations += before.rhs_evaluations;
        state = run.solution.final_state;
    }
    return status;
}

class PointsOfRods {
public:
    PointsOfRods(const ScanPlan& plan, const OutputUnits& units, const std::function<bool()>& stop)
        : plan_(plan), units_(units), stop_(stop), problem_(plan) {
        if (plan.certificates && plan.design.kind == scan::Kind::adaptive)
            lattice_.emplace(plan.design);
    }

    void evaluate(std::span<const scan::Point> points, std::span<scan::Result> results) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            results[i].point = points[i];
            guarded(results[i], [&](Clock::time_point start) { begin(i, results[i], start); });
        }
        for (Batch& batch : batches_)
            run(batch, results);
        batches_.clear();
    }

private:
    /// Pairs of one tolerance, and the points they are.
    struct Batch {
        rods::PairOptions options;
        std::vector<rods::PairProblem> pairs;
        std::vector<std::size_t> points;
        bool certified = false;
    };

    /// Runs `work`; exceptions become failures of the point.
    template<class Work>
    static void guarded(scan::Result& result, const Work& work) {
        const auto start = Clock::now();
        try {
            work(start);
        } catch (const std::exception& error) {
            result.status = scan::Status::exception;
            result.set_cause(rodwake::describe(error));
        }
        result.seconds += seconds_since(start);
    }

    /// Puts the point into a batch, or finishes it.
    void begin(std::size_t number, scan::Result& result, Clock::time_point start) {
        const rods::RodProblem& problem = problem_.at(result.point);
        if (auto met = rods::contact_at_start(problem)) {
            met->outcome.certificate = rods::certificate_at_start(problem, met->outcome);
            store_certain_capture(plan_, met->outcome.ending, result);
            return store(end_of(problem, *met, {}), plan_, units_, result);
        }

        // With noise a point is an ensemble; one whose noise is 0 has one run and no interval.
        rods::RodOptions options = rod_options(problem_.run(), problem);
        if (plan_.base.noise) {
            if (const std::optional<NoisePlan> noise = problem_.noise()) {
                options.ode.stop_requested = stop_condition(start);
                if (!evaluate_noisy(plan_, problem, options, *noise, units_, result))
                    interrupted(result, start);
                return;
            }
            options.criteria = rods::noisy_criteria; // as for its neighbours
            return climb(problem, options, result, start);
        }

        const auto pair = rods::to_pair_problem(problem);
        if (!pair || !suits_batch(problem_.run(), options, plan_.time_limit))
            return climb(problem, options, result, start);
        rods::validate(*pair);

        // There is more than one batch only if the tolerance is an axis.
        const rods::PairOptions own = pair_options(options.ode, plan_.critical.has_value());
        const bool certificate = certified(result.point);
        auto batch = std::ranges::find_if(batches_, [&](const Batch& other) {
            return other.certified == certificate && other.options.rtol == own.rtol &&
                   other.options.atol == own.atol && other.options.max_attempts == own.max_attempts;
        });
        if (batch == batches_.end())
            batch = batches_.insert(batches_.end(), Batch{own, {}, {}, certificate});
        batch->pairs.push_back(*pair);
        batch->points.push_back(number);
    }

    /// Only points of the lattice get certificates: those on edges, which bisect a boundary, just locate it.
    bool certified(const scan::Point& point) const {
        return plan_.certificates && (!lattice_ || lattice_->point(lattice_->place(point.id)).at == point.at);
    }

    void run(const Batch& batch, std::span<scan::Result> results) {
        const auto start = Clock::now();
        std::vector<rods::PairResult> ends(batch.pairs.size());
        if (batch.certified)
            rods::simulate_certified(batch.pairs, batch.options, ends);
        else
            rods::simulate_pairs(batch.pairs, batch.options, ends);
        const double each = seconds_since(start) / static_cast<double>(ends.size());
        for (std::size_t k = 0; k < ends.size(); ++k) {
            scan::Result& result = results[batch.points[k]];
            result.seconds += each;
            guarded(result, [&](Clock::time_point began) {
                const rods::RodProblem& problem = problem_.at(result.point);
                rods::RodOptions options = rod_options(problem_.run(), problem);
                bool done = !ends[k].handed_over();
                if (done) {
                    EncounterEnd end = end_of(batch.pairs[k], ends[k]);
                    if (plan_.decide && end.ending == Ending::undecided) {
                        FrontRodTracker leader(problem, ends[k]);
                        end.failed = rods::outcome_of(batch.pairs[k], ends[k], batch.options.criteria).failed;
                        options.ode.stop_requested = stop_condition(began);
                        const std::vector<double> state(ends[k].state.begin(), ends[k].state.end());
                        const integrate::Status status =
                            decide(problem, options, t_end_limit(problem), state, leader, end,
                                   &problem_.run(), plan_.critical.has_value());
                        if (status.termination == Termination::interrupted)
                            return interrupted(result, began);
                        done = status.ok();
                    }
                    store(end, plan_, units_, result);
                }
                if (done && result.ok())
                    return;
                const bool limit_of_batch = batch.options.max_attempts < options.ode.max_steps;
                if (ends[k].end == rods::PairEnding::too_many_steps && limit_of_batch)
                    options.ode.method = Method::bdf; // faster from there on
                climb(problem, options, result, began);
            });
        }
    }

    /// Runs the point alone, and again with other options as long as it fails and a retry is left.
    void climb(const rods::RodProblem& problem, rods::RodOptions options, scan::Result& result,
               Clock::time_point start) const {
        options.ode.stop_requested = stop_condition(start);
        std::string causes;
        for (result.retries = 0;; ++result.retries) {
            try {
                FrontRodTracker leader(problem);
                if (problem.rods.size() == 2)
                    options.ode.on_step = [&](const integrate::Step& step) { leader.add(step.state); };
                const rods::RodResult run = certified(result.point) || rods::walks_straight(problem)
                                                ? rods::simulate_certified(problem, options, true)
                                                : rods::simulate(problem, options);
                EncounterEnd end = end_of(problem, run, leader.ahead());
                integrate::Status status = run.solution.status;
                if (plan_.decide && status.ok() && status.termination != Termination::interrupted &&
                    end.ending == Ending::undecided)
                    status =
                        decide(problem, options, t_end_limit(problem), run.solution.final_state, leader, end);
                // a proof that was stopped leaves its outcome open, which the uninterrupted scan may not have
                const bool cut_short = stop_ && stop_() && certified(result.point) &&
                                       run.outcome.certificate == Certificate::open;
                if (status.termination == Termination::interrupted || cut_short) {
                    interrupted(result, start);
                } else if (status.ok()) {
                    store_certain_capture(plan_, end.ending, result);
                    store(end, plan_, units_, result);
                } else {
                    result.status = scan::Status::failed;
                    result.set_cause(fmt::format("{}: {}; {}", status.flag, status.cause, status.advice));
                }
            } catch (const std::exception& error) {
                result.status = scan::Status::exception;
                result.set_cause(rodwake::describe(error));
            }
            const bool hopeless = result.status == scan::Status::ok ||
                                  result.status == scan::Status::time_limit ||
                                  result.status == scan::Status::stopped;
            const std::string cause(result.ok() ? "" : result.cause_text());
            if (!scan::cause_pattern(causes).ends_with(scan::cause_pattern(cause))) // a retry may fail alike
                causes += (causes.empty() ? "" : "; ") + cause;
            if (hopeless || !next_rung(options, result.retries))
                break;
        }
        if (!result.ok() || !causes.empty())
            result.set_cause(causes);
    }

    /// In reduced units, as the times of problems.
    double t_end_limit(const rods::RodProblem& problem) const {
        return problem_.run().t_end_limit.value_or(1000.0 * problem.t_end);
    }

    void interrupted(scan::Result& result, Clock::time_point start) const {
        const bool late = seconds_since(start) > plan_.time_limit.value_or(HUGE_VAL);
        result.status = late ? scan::Status::time_limit : scan::Status::stopped;
        result.set_cause(fmt::format("more than {:g} s", plan_.time_limit.value_or(0.0)));
    }

    std::function<bool()> stop_condition(Clock::time_point start) const {
        const double limit = plan_.time_limit.value_or(HUGE_VAL);
        if (limit == HUGE_VAL && !stop_)
            return nullptr;
        return [this, start, limit] { return (stop_ && stop_()) || seconds_since(start) > limit; };
    }

    const ScanPlan& plan_;
    const OutputUnits& units_;
    const std::function<bool()>& stop_;
    PointProblem problem_;
    std::vector<Batch> batches_;
    std::optional<scan::Lattice> lattice_; ///< of an adaptive scan with certificates
};

} // namespace

scan::Evaluate evaluate_rods(const ScanPlan& plan, std::function<bool()> stop) {
    return [&plan, units = output_units(plan.base),
            stop = std::move(stop)](std::span<const scan::Point> points, std::span<scan::Result> results) {
        PointsOfRods(plan, units, stop).evaluate(points, results);
    };
}

std::function<double(const scan::Result&)> side_of_pursuit(const ScanPlan& plan) {
    if (of_beds(plan) || plan.base.rods.size() != 2 || plan.base.noise)
        return nullptr;
    EncounterEnd end;
    end.turn.resize(2);
    std::size_t turn = 0, next = 0; // where that of rod 0 stands among the values
    for_each_number(end, told_turns, [&](const auto&, int rod, double) {
        turn = rod == 0 ? next : turn;
        ++next;
    });
    return [turn, problem = std::make_shared<PointProblem>(plan)](const scan::Result& result) {
        if (result.outcome != static_cast<std::int32_t>(Ending::undecided))
            return std::nan("");
        const std::vector<rods::Pose>& start = problem->at(result.point).rods;
        const double angle = std::remainder(start[1].heading + result.values[turn + 1] - start[0].heading -
                                                result.values[turn],
                                            2.0 * std::numbers::pi);
        return std::abs(angle) < 0.5 * std::numbers::pi ? angle : std::nan("");
    };
}

rods::RodResult trajectory_of(const ScanPlan& plan, const scan::Result& result, std::size_t times) {
    scene::Scene scene = plan.base;
    if (const auto wrong = set_point(plan, scene, result.point))
        throw InputError(*wrong);
    rods::RodProblem problem = rod_problem(scene);
    const double end = result.values[0] / output_units(plan.base).time;
    problem.t_end = std::max(problem.t_end, end); // of a point that went on until it was decided
    problem.output_times.clear();
    for (std::size_t i = 0; i + 1 < times; ++i)
        problem.output_times.push_back(end * static_cast<double>(i) / static_cast<double>(times - 1));
    rods::RodOptions options = rod_options(*scene.rods_run, problem);
    if (const auto noise = noise_plan(scene, problem))
        return rods::simulate(problem, options, noise->noise, 0);
    for (int rung = 0; rung < result.retries; ++rung) // as the attempt that succeeded
        next_rung(options, rung);
    return rods::simulate(problem, options);
}

} // namespace rodwake::app
