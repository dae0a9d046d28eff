// The tradeoff stage: a reference, then every setting against it.

#include "answer.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "run/log.hpp"
#include "run/session.hpp"
#include "run/stage_list.hpp"
#include "scan/scan_request.hpp"
#include "scan/scan_rods.hpp"
#include "theory/wake_fields.hpp"
#include "tradeoff_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

namespace rodwake::app {

// The work that is solved by each setting: the rods of a scene once, or a sample of its scan.

struct Subject {
    std::string unit;
    std::vector<Setting> settings;
    std::array<integrate::Method, 2> reference; ///< methods that suit the work
    /// Sets the work up; what it returns does it, again and again, until `stop`. Both throw InputError for
    /// what the setting cannot do.
    using Work = std::function<Answer()>;
    std::function<Work(const Setting&, std::function<bool()> stop)> prepare;
};

/// Of the scene as written, without its variants. The session must outlive it.
Subject subject_of_rods(const Session& session);
/// A thousand points at random between the ends of the axes; of a list its rows, a thousand at most.
Subject subject_of_scan(const Session& session);

namespace {

using Clock = std::chrono::steady_clock;

constexpr double timed_for = 0.05; ///< s, of repeats of a setting
constexpr long least_repeats = 3, most_repeats = 100;
constexpr double long_run = 1.0;  ///< s; such a run is not repeated
constexpr double quick_run = 0.2; ///< s; such a run is timed again when all settings have had their turn
constexpr double least_over_agreement = 10.0;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

class Measurement {
public:
    Measurement(const Session& session, const Subject& subject) : session_(session), subject_(subject) {}

    bool stopped() const { return session_.context.stopped(); }

    /// Each once and both at a time, within `limit` seconds. One that cannot be set up, or has no result,
    /// says why.
    std::array<Answer, 2> solve_both(const std::array<Setting, 2>& settings, double limit) const {
        std::array<Answer, 2> answers;
        std::array<Subject::Work, 2> work;
        Clock::time_point start;
        for (std::size_t k = 0; k < 2; ++k)
            guarded(answers[k], [&] { work[k] = subject_.prepare(settings[k], until(start, limit)); });
        start = Clock::now();
        parallel_for(2, session_.context.thread_count(), [&](std::size_t k) {
            if (work[k])
                guarded(answers[k], [&] { answers[k] = work[k](); });
        });
        return answers;
    }

    Trial measure(const Setting& setting, const Answer& reference, const Errors& least) const {
        Trial trial{setting, {}, HUGE_VAL, 0, 0, "ok"};
        trial.error.fill(HUGE_VAL);
        const Answer answer = time(trial);
        trial.rhs_evaluations = answer.rhs_evaluations;
        if (!answer.failure.empty())
            trial.status = answer.failure;
        if (!answer.failure.empty() || answer.encounters.empty())
            return trial;
        trial.error = errors_between(answer, reference);
        for (std::size_t kind = 0; kind < error_kinds; ++kind)
            if (trial.error[kind] < least[kind])
                trial.error[kind] = least[kind];
        return trial;
    }

    /// Into `seconds`, the least of these and earlier repeats, and `repeats`. The answer of the last one that
    /// has any; one that was stopped, or given up after others were not, counts for nothing.
    Answer time(Trial& trial) const {
        Answer answer;
        Clock::time_point start;
        guarded(answer, [&] {
            const Subject::Work work =
                subject_.prepare(trial.setting, until(start, session_.context.tradeoff.limit));
            double all = 0.0;
            for (long turn = 0; turn == 0 || goes_on(trial, turn, all); ++turn) {
                start = Clock::now();
                const Stopwatch watch;
                Answer found = work();
                const double took = watch.seconds();
                if (stopped() || (!found.failure.empty() && trial.repeats > 0))
                    return;
                answer = std::move(found);
                trial.seconds = std::min(trial.seconds, took);
                ++trial.repeats;
                all += took;
            }
        });
        return answer;
    }

private:
    template<class Work>
    static void guarded(Answer& answer, const Work& work) {
        try {
            work();
        } catch (const std::exception& error) {
            answer.failure = describe(error);
        }
    }

    /// From a start that is set later.
    std::function<bool()> until(const Clock::time_point& start, double limit) const {
        return [this, limit, &start] { return stopped() || seconds_since(start) > limit; };
    }

    bool goes_on(const Trial& trial, long turn, double all) const {
        return !stopped() && turn < most_repeats && trial.seconds < long_run &&
               (turn < least_repeats || all < timed_for);
    }

    const Session& session_;
    const Subject& subject_;
};

/// How far apart the methods are: in the kind that is asked for, if there is any, then in the last state.
std::pair<double, double> distance(const Errors& apart, ErrorKind kind) {
    const double asked = apart[static_cast<std::size_t>(kind)];
    if (kind == ErrorKind::outcome && !(asked < 0.5)) // which of the two is right?
        return {HUGE_VAL, HUGE_VAL};
    return {std::isnan(asked) ? 0.0 : asked, apart[static_cast<std::size_t>(ErrorKind::final_state)]};
}

/// Tightened as long as that brings the two methods together. Throws RunError if one of them has no answer.
Answer make_reference(const Session& session, const Measurement& measurement, const Subject& subject,
                      Tradeoff& table) {
    Answer best;
    std::pair least{HUGE_VAL, HUGE_VAL};
    const double limit = 10.0 * session.context.tradeoff.limit;
    std::string failure;
    for (const double tolerance : {1e-11, 1e-12, 1e-13}) {
        std::array<Setting, 2> settings;
        for (std::size_t k = 0; k < 2; ++k) {
            settings[k].method = subject.reference[k];
            settings[k].tolerance = tolerance;
            settings[k].field = subject.settings.front().field; // exact, or measured
        }
        std::array<Answer, 2> pair = measurement.solve_both(settings, limit);
        for (std::size_t k = 0; k < 2; ++k)
            failure = pair[k].failure.empty() ? failure : table.methods[k] + ": " + pair[k].failure;
        if (measurement.stopped())
            return best;
        if (!pair[0].failure.empty() || !pair[1].failure.empty())
            continue;
        const Errors apart = errors_between(pair[0], pair[1]);
        session.log->info("tradeoff: reference at rtol {:g}: {} and {} agree to {:.2g}", tolerance,
                          table.methods[0], table.methods[1], apart[static_cast<std::size_t>(table.kind)]);
        if (!(distance(apart, table.kind) < least))
            continue;
        least = distance(apart, table.kind);
        best = std::move(pair[0]);
        table.agreement = apart;
        table.tolerance = tolerance;
    }
    if (best.encounters.empty())
        throw RunError("tradeoff: no reference: methods " + table.methods[0] + " and " + table.methods[1] +
                       (failure.empty() ? " do not agree on the outcome"
                                        : " have no answers to compare (" + failure + ")") +
                       "; a shorter run, or a longer --limit, may have one");
    for (std::size_t kind = 0; kind < error_kinds; ++kind)
        table.least[kind] = least_over_agreement * table.agreement[kind];
    return best;
}

void tell_reference(const Session& session, const Tradeoff& table) {
    const auto kind = static_cast<std::size_t>(table.kind);
    session.log->info(
        "tradeoff: the reference is {} at rtol {:g}; errors below {:.2g} ({}), ten times what the two "
        "methods agree to, are quoted as that",
        table.methods[0], table.tolerance, table.least[kind], to_string(table.kind));
}

void write(const Session& session, const Tradeoff& table) {
    session.directory.write("tradeoff.json", tradeoff_json(table));
    session.directory.write("tradeoff.csv", tradeoff_csv(table));
}

/// What an interrupted measurement of the same work left, but for what a longer limit may bring to its end.
std::vector<Trial> earlier_trials(const Session& session, const Tradeoff& table) {
    if (session.context.force || !std::filesystem::exists(session.directory.file("tradeoff.json")))
        return {};
    Tradeoff earlier = read_tradeoff(session.directory.path());
    if (earlier.work != table.work)
        return {};
    if (earlier.limit < table.limit)
        std::erase_if(earlier.trials, [](const Trial& trial) { return trial.status == took_too_long; });
    return earlier.trials;
}

Tradeoff empty_table(const Session& session, const Subject& subject) {
    Tradeoff table;
    table.unit = subject.unit;
    table.work = work_of(session.plan);
    table.kind = session.context.tradeoff.kind;
    table.limit = session.context.tradeoff.limit;
    for (std::size_t k = 0; k < 2; ++k)
        table.methods[k] = integrate::to_string(subject.reference[k]);
    return table;
}

/// False: stopped on the way.
bool measure_all(const Session& session, const Subject& subject, const Measurement& measurement,
                 const Answer& reference, Tradeoff& table) {
    const std::vector<Trial> earlier = earlier_trials(session, table);
    Progress progress(session.context, "tradeoff", static_cast<double>(subject.settings.size()), "settings");
    Clock::time_point written = Clock::now();
    for (const Setting& setting : subject.settings) {
        const auto known = std::ranges::find(earlier, setting, &Trial::setting);
        Trial trial = known != earlier.end() ? *known : measurement.measure(setting, reference, table.least);
        if (measurement.stopped())
            return false;
        table.trials.push_back(std::move(trial));
        progress.update(static_cast<double>(table.trials.size()));
        if (seconds_since(written) > 1.0) {
            write(session, table);
            written = Clock::now();
        }
    }
    return true;
}

/// What else the machine does comes and goes: a setting that met it has a second chance.
void time_again(const Measurement& measurement, Tradeoff& table) {
    for (Trial& trial : table.trials)
        if (!measurement.stopped() && trial.status == "ok" && trial.seconds < quick_run)
            measurement.time(trial);
}

} // namespace

std::string work_of(const Plan& plan) {
    return plan.scan ? fmt::format("{}seed {}\n", plan.scan->description, plan.scan->design.seed) : "";
}

StageEnd run_tradeoff_stage(Session& session) {
    const Subject subject = session.plan.scan ? subject_of_scan(session) : subject_of_rods(session);
    const Measurement measurement(session, subject);
    Tradeoff table = empty_table(session, subject);
    session.log->info("tradeoff: {} settings, each timed on one thread; the work is {}",
                      subject.settings.size(), subject.unit);
    const Answer reference = make_reference(session, measurement, subject, table);
    if (measurement.stopped())
        return StageEnd::interrupted;
    tell_reference(session, table);
    if (measure_all(session, subject, measurement, reference, table))
        time_again(measurement, table);
    write(session, table);
    return measurement.stopped() ? StageEnd::interrupted : StageEnd::finished;
}

namespace {

using integrate::Method;

constexpr long sampled = 1000;
constexpr double stiff = 30.0; ///< rods::suitable_method

Encounter encounter_of(const rods::RodResult& run) {
    const bool solved =
        run.solution.status.ok() && run.solution.status.termination != integrate::Termination::interrupted;
    return {solved, run.outcome.ending, run.outcome.time, run.solution.final_state, run.solution.states};
}

Answer answer_of(const rods::RodResult& run) {
    const integrate::Status& status = run.solution.status;
    Answer answer{{encounter_of(run)}, run.solution.statistics.rhs_evaluations, {}};
    if (status.termination == integrate::Termination::interrupted)
        answer.failure = took_too_long;
    else if (!status.ok())
        answer.failure = "failed: " + status.flag;
    return answer;
}

bool interacts(const rods::RodProblem& problem) {
    return problem.medium && problem.couplings.any() && (problem.rods.size() > 1 || problem.box);
}

/// The rods of the scene; stiff ones by BDF first.
std::array<Method, 2> reference_methods(const rods::RodProblem& problem) {
    return {Method::erk, rods::stiffness(problem) > stiff ? Method::bdf : Method::adams};
}

/// Columns of a scan that tell how a point ends, by their place in Result::values.
struct EndColumns {
    std::size_t time, separation, rhs_evaluations;
    std::vector<std::size_t> turns;

    explicit EndColumns(const std::vector<std::string>& names)
        : time(place(names, "time")), separation(place(names, "final_separation")),
          rhs_evaluations(place(names, "rhs_evaluations")) {
        for (std::size_t k = 0; k < names.size(); ++k)
            if (names[k].starts_with("turn"))
                turns.push_back(k);
    }

    static std::size_t place(const std::vector<std::string>& names, const std::string& name) {
        const auto at = std::ranges::find(names, name);
        if (at == names.end())
            throw std::logic_error("tradeoff: a scan has no column " + name);
        return static_cast<std::size_t>(at - names.begin());
    }
};

Encounter encounter_of(const scan::Result& point, const EndColumns& end_columns, const OutputUnits& units) {
    Encounter end{
        point.ok(), static_cast<Ending>(point.outcome), point.values[end_columns.time] / units.time, {}, {}};
    end.final_state.push_back(point.values[end_columns.separation] / units.length);
    for (const std::size_t k : end_columns.turns)
        end.final_state.push_back(point.values[k]);
    return end;
}

Answer answer_of(std::span<const scan::Result> points, const ScanPlan& plan) {
    const EndColumns end_columns(plan.columns.observables);
    const OutputUnits units = output_units(plan.base);
    Answer answer;
    for (const scan::Result& point : points) {
        answer.encounters.push_back(encounter_of(point, end_columns, units));
        if (point.status == scan::Status::stopped)
            answer.failure = took_too_long;
        else if (point.ok())
            answer.rhs_evaluations += static_cast<long>(point.values[end_columns.rhs_evaluations]);
    }
    return answer;
}

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

} // namespace

Subject subject_of_rods(const Session& session) {
    const auto fields = std::make_shared<WakeFields>(session); // a table is made once
    return {"a run", settings_of(session.plan.scene), reference_methods(rod_problem(session.plan.scene)),
            [&session, fields](const Setting& setting, std::function<bool()> stop) -> Subject::Work {
                const scene::Scene scene = with(session.plan.scene, setting);
                rods::RodProblem problem = rod_problem(scene);
                if (interacts(problem) && setting.field != scene::FieldBackend::exact)
                    problem.field = fields->of(scene);
                rods::RodOptions options = rod_options(*scene.rods_run, problem);
                options.ode.stop_requested = std::move(stop);
                return [problem = std::move(problem), options = std::move(options)] {
                    return answer_of(rods::simulate(problem, options));
                };
            }};
}

Subject subject_of_scan(const Session& session) {
    const scene::Scene& scene = session.plan.scene;
    const auto points = std::make_shared<const std::vector<scan::Point>>(sample(session.plan.scan->design));
    return {fmt::format("{} points of the scan", points->size()),
            settings_of(scene),
            {Method::erk, Method::bdf},
            [&session, points](const Setting& setting, std::function<bool()> stop) -> Subject::Work {
                const scene::Scene varied = with(session.plan.scene, setting);
                const auto plan = std::make_shared<const ScanPlan>(plan_scan(varied, read_scan_list(varied)));
                return [plan, points, evaluate = evaluate_rods(*plan, std::move(stop))] {
                    std::vector<scan::Result> results(points->size());
                    evaluate(*points, results);
                    return answer_of(results, *plan);
                };
            }};
}

} // namespace rodwake::app
