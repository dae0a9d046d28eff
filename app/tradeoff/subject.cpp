#include "subject.hpp"

#include "scan/scan_request.hpp"
#include "scan/scan_rods.hpp"
#include "theory/wake_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace rodwake::app {

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

Encounter encounter_of(const scan::Result& point, const EndColumns& columns, const OutputUnits& units) {
    Encounter end{
        point.ok(), static_cast<Ending>(point.outcome), point.values[columns.time] / units.time, {}, {}};
    end.final_state.push_back(point.values[columns.separation] / units.length);
    for (const std::size_t k : columns.turns)
        end.final_state.push_back(point.values[k]);
    return end;
}

Answer answer_of(std::span<const scan::Result> points, const ScanPlan& plan) {
    const EndColumns columns(plan.columns.observables);
    const OutputUnits units = output_units(plan.base);
    Answer answer;
    for (const scan::Result& point : points) {
        answer.encounters.push_back(encounter_of(point, columns, units));
        if (point.status == scan::Status::stopped)
            answer.failure = took_too_long;
        else if (point.ok())
            answer.rhs_evaluations += static_cast<long>(point.values[columns.rhs_evaluations]);
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
