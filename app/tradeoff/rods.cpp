// The rods of a scene, solved once or at a sample of its scan: the reference, and what each setting finds.

#include "rodwake/core/encounter.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "run/session.hpp"
#include "scan/scan_parts.hpp"
#include "target.hpp"
#include "theory/wake_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace rodwake::app {

namespace {

using integrate::Method;
using Clock = std::chrono::steady_clock;

constexpr long sampled = 1000;
constexpr double stiff = 30.0;     ///< rods::suitable_method
constexpr double kept_by = 0.95;   ///< of the points of a scan
constexpr double timed_for = 0.05; ///< s, of repeats of a setting
constexpr long least_repeats = 3, most_repeats = 100;
constexpr double long_run = 1.0;  ///< s; such a run is not repeated
constexpr double quick_run = 0.2; ///< s; such a run is timed again when all settings have had their turn
constexpr double least_over_agreement = 10.0;

// --- errors -----------------------------------------------------------------------------------------------

double largest_difference(double a, double b) { return std::abs(a - b); }

/// Up to the shorter end, for one of two runs into contact may have an output time more; of states all.
template<class T>
double largest_difference(const std::vector<T>& a, const std::vector<T>& b) {
    double largest = std::is_floating_point_v<T> && a.size() != b.size() ? HUGE_VAL : 0.0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        largest = std::max(largest, largest_difference(a[i], b[i]));
    return largest;
}

RodErrors errors_of(const Encounter& a, const Encounter& b) {
    const auto or_unknown = [](bool there, double error) { return Unbounded{there ? error : NAN}; };
    const bool contact = !std::isnan(b.contact_time), path = !b.path.empty();
    if (!a.solved || !b.solved || a.ending != b.ending)
        return {{HUGE_VAL}, or_unknown(contact, HUGE_VAL), {1.0}, or_unknown(path, HUGE_VAL)};
    const double state = largest_difference(a.final_state, b.final_state);
    return {{state},
            or_unknown(contact, largest_difference(a.contact_time, b.contact_time)),
            {0.0},
            or_unknown(path, std::max(state, largest_difference(a.path, b.path)))};
}

/// What this share of the numbers keeps to; NaN if there are none.
double quantile(std::vector<double> values, double share) {
    std::erase_if(values, [](double v) { return std::isnan(v); });
    if (values.empty())
        return NAN;
    const auto last = static_cast<double>(values.size() - 1);
    const auto at = values.begin() + std::lround(std::ceil(share * last));
    std::ranges::nth_element(values, at);
    return *at;
}

// --- the work ---------------------------------------------------------------------------------------------

struct Answer {
    std::vector<Encounter> encounters;
    long rhs_evaluations = 0;
    std::string failure; ///< empty: none
};

/// What is set up does it, again and again, until it is stopped.
using TimedWork = std::function<Answer()>;
using Stop = std::function<bool()>;

Encounter encounter(bool solved, Ending ending, double time) {
    return {solved, ending, ending == Ending::contact ? time : NAN, {}, {}};
}

Answer answer_of(const rods::RodResult& run) {
    const integrate::Status& status = run.solution.status;
    const bool interrupted = status.termination == integrate::Termination::interrupted;
    Encounter end = encounter(status.ok() && !interrupted, run.outcome.ending, run.outcome.time);
    end.final_state = run.solution.final_state;
    end.path = run.solution.states;
    return {{std::move(end)},
            run.solution.statistics.rhs_evaluations,
            interrupted    ? took_too_long
            : !status.ok() ? "failed: " + status.flag
                           : ""};
}

bool interacts(const rods::RodProblem& problem) {
    return problem.medium && problem.couplings.any() && (problem.rods.size() > 1 || problem.box);
}

/// Of the points of a scan the columns that tell how they end.
Answer answer_of(std::span<const scan::Result> points, const ScanPlan& plan) {
    const std::vector<std::string>& names = plan.columns.observables;
    const auto column = [&](std::string_view name) {
        const auto at = std::ranges::find(names, name);
        if (at == names.end())
            throw std::logic_error(fmt::format("tradeoff: a scan has no column {}", name));
        return static_cast<std::size_t>(at - names.begin());
    };
    const std::size_t time = column("time"), separation = column("final_separation"),
                      rates = column("rhs_evaluations");
    const OutputUnits units = output_units(plan.base);
    Answer answer;
    for (const scan::Result& point : points) {
        Encounter& end = answer.encounters.emplace_back(
            encounter(point.ok(), static_cast<Ending>(point.outcome), point.values[time] / units.time));
        end.final_state.push_back(point.values[separation] / units.length);
        for (std::size_t k = 0; k < names.size(); ++k)
            if (names[k].starts_with("turn"))
                end.final_state.push_back(point.values[k]);
        if (point.status == scan::Status::stopped)
            answer.failure = took_too_long;
        else if (point.ok())
            answer.rhs_evaluations += static_cast<long>(point.values[rates]);
    }
    return answer;
}

/// A thousand points at random between the ends of the axes; of a list its rows, a thousand at most.
std::vector<scan::Point> sample(scan::Design design) {
    design.runs = 0;
    design.costs.clear();
    if (design.kind != scan::Kind::list)
        design.kind = scan::Kind::lhs;
    design.samples = sampled;
    const scan::PointList list(design);
    std::vector<scan::Point> points;
    for (std::int64_t k = 0; k < std::min<std::int64_t>(list.size(), sampled); ++k)
        points.push_back(list[k]);
    return points;
}

template<class Call>
void guarded(Answer& answer, const Call& call) {
    try {
        call();
    } catch (const std::exception& error) {
        answer.failure = rodwake::describe(error);
    }
}

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

class RodsTarget : public Target {
public:
    explicit RodsTarget(const Session& session)
        : session_(session), limit_(session.context.tradeoff.limit), fields_(session) {
        const scene::Scene& scene = session.plan.scene;
        table.part = Part::rods;
        table.kind = session.context.tradeoff.kind;
        table.limit = limit_;
        table.work = work_of(session.plan);
        table.unit = "a run";
        for (const Setting& setting : settings_of(scene))
            table.ways.push_back({.setting = setting});
        Method second = Method::bdf; // suits points of a scan, and stiff rods
        if (session.plan.scan) {
            points_ = sample(session.plan.scan->design);
            table.unit = fmt::format("{} points of the scan", points_.size());
        } else if (rods::stiffness(rod_problem(scene)) <= stiff) {
            second = Method::adams;
        }
        table.rods.methods = {integrate::to_string(Method::erk), integrate::to_string(second)};
    }

    /// Tightened as long as that brings the two methods together. Throws RunError if one of them has no
    /// answer.
    bool begin() override {
        std::pair least{HUGE_VAL, HUGE_VAL};
        std::string failure;
        RodReference& rods = table.rods;
        for (const double tolerance : {1e-11, 1e-12, 1e-13}) {
            std::array<Answer, 2> pair = solve_both(tolerance);
            for (std::size_t k = 0; k < 2; ++k)
                failure = pair[k].failure.empty() ? failure : rods.methods[k] + ": " + pair[k].failure;
            if (stopped())
                return false;
            if (!pair[0].failure.empty() || !pair[1].failure.empty())
                continue;
            const RodErrors apart = errors_between(pair[0].encounters, pair[1].encounters);
            session_.log->info("tradeoff: reference at rtol {:g}: {} and {} agree to {:.2g}", tolerance,
                               rods.methods[0], rods.methods[1], asked(apart));
            if (!(distance(apart) < least))
                continue;
            least = distance(apart);
            reference_ = std::move(pair[0].encounters);
            rods.agreement = apart;
            rods.tolerance = tolerance;
        }
        require_reference(failure);
        for_each_field<RodErrors>([&](const auto& field) {
            (rods.least.*field.member).value = least_over_agreement * (rods.agreement.*field.member);
        });
        session_.log->info(
            "tradeoff: the reference is {} at rtol {:g}; errors below {:.2g} ({}), ten times what the two "
            "methods agree to, are quoted as that",
            rods.methods[0], rods.tolerance, asked(rods.least), table.kind);
        return true;
    }

    bool attempt(std::size_t k) override {
        Way& way = table.ways[k];
        const Answer answer = time(way);
        way.rhs_evaluations = answer.rhs_evaluations;
        RodErrors errors; // infinite
        if (!answer.failure.empty())
            way.status = answer.failure;
        else if (!answer.encounters.empty())
            errors = errors_between(answer.encounters, reference_);
        for_each_field<RodErrors>([&](const auto& field) {
            const double least = table.rods.least.*field.member;
            Unbounded& error = errors.*field.member;
            error.value = error < least ? least : error.value;
        });
        way.found = found_of(errors);
        return !stopped();
    }

    /// What else the machine does comes and goes: a setting that met it has a second chance.
    void again(Way& way) override {
        if (way.status == "ok" && way.seconds < quick_run)
            time(way);
    }

private:
    bool stopped() const { return session_.context.stopped(); }

    double asked(const RodErrors& errors) const { return error_of(errors, table.kind); }

    /// How far apart the methods are: in the kind that is asked for, if there is any, then in the last state.
    std::pair<double, double> distance(const RodErrors& apart) const {
        const double error = asked(apart);
        if (table.kind == "outcome" && !(error < 0.5))
            return {HUGE_VAL, HUGE_VAL}; // which of the two is right?
        return {std::isnan(error) ? 0.0 : error, apart.final_state};
    }

    void require_reference(const std::string& failure) const {
        if (reference_.empty())
            throw RunError("tradeoff: no reference: methods " + table.rods.methods[0] + " and " +
                           table.rods.methods[1] +
                           (failure.empty() ? " do not agree on the outcome"
                                            : " have no answers to compare (" + failure + ")") +
                           "; a shorter run, or a longer --limit, may have one");
    }

    /// Throws InputError for what the setting cannot do.
    TimedWork prepare(const Setting& setting, Stop stop) {
        scene::Scene scene = with(session_.plan.scene, setting);
        if (session_.plan.scan) {
            const auto plan = std::make_shared<const ScanPlan>(plan_scan(scene, read_scan_list(scene)));
            return [this, plan, evaluate = evaluate_rods(*plan, std::move(stop))] {
                std::vector<scan::Result> results(points_.size());
                evaluate(points_, results);
                return answer_of(results, *plan);
            };
        }
        rods::RodProblem problem = rod_problem(scene);
        if (interacts(problem) && setting.field != "exact")
            problem.field = fields_.of(scene); // a table is made once
        rods::RodOptions options = rod_options(*scene.rods_run, problem);
        options.ode.stop_requested = std::move(stop);
        return [problem = std::move(problem), options = std::move(options)] {
            return answer_of(rods::simulate(problem, options));
        };
    }

    /// From a start that is set later.
    Stop until(const Clock::time_point& start, double limit) const {
        return [this, limit, &start] { return stopped() || seconds_since(start) > limit; };
    }

    /// Each method of the reference once and both at a time, in the exact or the measured field. One that
    /// cannot be set up, or has no result, says why.
    std::array<Answer, 2> solve_both(double tolerance) {
        std::array<Answer, 2> answers;
        std::array<TimedWork, 2> work;
        Clock::time_point start;
        for (std::size_t k = 0; k < 2; ++k)
            guarded(answers[k], [&] {
                work[k] = prepare({.method = table.rods.methods[k],
                                   .field = table.ways.front().setting.field,
                                   .tolerance = tolerance},
                                  until(start, 10.0 * limit_));
            });
        start = Clock::now();
        parallel_for(2, session_.context.thread_count(), [&](std::size_t k) {
            if (work[k])
                guarded(answers[k], [&] { answers[k] = work[k](); });
        });
        return answers;
    }

    /// Into `seconds`, the least of these and earlier repeats, and `runs`. The answer of the last one that
    /// has any; one that was stopped, or given up after others were not, counts for nothing.
    Answer time(Way& way) {
        Answer answer;
        Clock::time_point start;
        guarded(answer, [&] {
            const TimedWork work = prepare(way.setting, until(start, limit_));
            double all = 0.0;
            for (long turn = 0; turn == 0 || goes_on(way, turn, all); ++turn) {
                start = Clock::now();
                const Stopwatch watch;
                Answer found = work();
                const double took = watch.seconds();
                if (stopped() || (!found.failure.empty() && way.runs > 0))
                    return;
                answer = std::move(found);
                way.seconds = std::min(way.seconds, took);
                ++way.runs;
                all += took;
            }
        });
        return answer;
    }

    bool goes_on(const Way& way, long turn, double all) const {
        return !stopped() && turn < most_repeats && way.seconds < long_run &&
               (turn < least_repeats || all < timed_for);
    }

    const Session& session_;
    double limit_;
    WakeFields fields_;
    std::vector<scan::Point> points_; ///< of a scan
    std::vector<Encounter> reference_;
};

} // namespace

RodErrors errors_between(const std::vector<Encounter>& runs, const std::vector<Encounter>& others) {
    std::vector<RodErrors> all;
    for (std::size_t i = 0; i < others.size(); ++i)
        all.push_back(errors_of(runs.at(i), others[i]));
    RodErrors errors;
    for_each_field<RodErrors>([&](const auto& field) {
        std::vector<double> each;
        each.reserve(all.size());
        for (const RodErrors& one : all)
            each.push_back(one.*field.member);
        (errors.*field.member).value = quantile(std::move(each), kept_by);
    });
    double differ = 0.0;
    for (const RodErrors& one : all)
        differ += one.outcome;
    errors.outcome = {differ / static_cast<double>(all.size())};
    return errors;
}

std::string work_of(const Plan& plan) {
    return plan.scan ? fmt::format("{}seed {}\n", plan.scan->description, plan.scan->design.seed) : "";
}

std::unique_ptr<Target> rods_target(const Session& session) { return std::make_unique<RodsTarget>(session); }

} // namespace rodwake::app
