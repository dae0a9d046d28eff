#include "checkpoint.hpp"
#include "progress.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/csv.hpp"
#include "signals.hpp"
#include "stages.hpp"

#include <fmt/format.h>

namespace rodwake::cli {

namespace {

/// The scene as written, or one of its variants.
struct Case {
    std::string name;   ///< group in result.h5
    std::string label;  ///< for legends
    std::string folder; ///< where its files go, "" or "variants/<name>/"
    scene::Scene scene;
    rods::RodProblem problem;
    rods::RodOptions options;
    rods::RodResult result;

    std::string checkpoint_file() const { return folder + "checkpoint.json"; }
};

Case make_case(std::string name, std::string label, std::string folder, scene::Scene scene) {
    Case one{std::move(name), std::move(label), std::move(folder), std::move(scene), {}, {}, {}};
    one.problem = rod_problem(one.scene);
    one.options.ode = ode_options(*one.scene.rods_run, one.problem);
    return one;
}

std::vector<Case> cases_of(const scene::Scene& scene) {
    std::vector<Case> cases;
    cases.push_back(make_case("scene", "", "", scene));
    for (const scene::Variant& variant : scene.variants)
        cases.push_back(make_case(variant.name, variant.label.empty() ? variant.name : variant.label,
                                  "variants/" + variant.name + "/", scene::apply_variant(scene, variant)));
    return cases;
}

void resume(const Session& session, Case& one) {
    const auto file = session.directory.file(one.checkpoint_file());
    one.options.resume_from = session.options.force ? std::nullopt : read_checkpoint(file, one.scene);
    if (one.options.resume_from)
        session.log->info("rods: going on from the checkpoint at t = {:.6g}", one.options.resume_from->time);
    else if (std::filesystem::exists(file))
        session.log->warn("{}: damaged, or of another scene or version; starting from the beginning",
                          file.string());
}

void solve(const Session& session, Case& one, bool show_progress) {
    Progress progress(session.log, !show_progress || session.options.quiet, "rods", one.problem.t_end, "t");
    one.options.ode.stop_requested = [] { return stop_signal() != 0; };
    one.options.ode.on_step = [&](const integrate::Step& step) { progress.update(step.time); };
    one.options.on_checkpoint = [&](const rods::RodCheckpoint& checkpoint) {
        session.directory.write(one.checkpoint_file(), checkpoint_json(checkpoint, one.scene));
    };
    resume(session, one);
    one.result = rods::simulate(one.problem, one.options);
    if (one.result.solution.status.outcome != integrate::Outcome::interrupted)
        std::filesystem::remove(session.directory.file(one.checkpoint_file()));
}

/// Columns t, x0, y0, theta0, x1, ... in output units; the end of the run (contact, failure) is the last row.
struct Columns {
    std::vector<std::string> names;
    std::vector<std::vector<double>> values;
};

Columns trajectory(const rods::RodResult& result, std::size_t rods, const OutputUnits& units) {
    Columns columns{{"t"}, std::vector<std::vector<double>>(1 + 3 * rods)};
    for (std::size_t rod = 0; rod < rods; ++rod)
        for (const char* name : {"x", "y", "theta"})
            columns.names.push_back(name + std::to_string(rod));
    const auto add = [&](double time, const std::vector<double>& state) {
        columns.values[0].push_back(time * units.time);
        for (std::size_t i = 0; i < state.size(); ++i)
            columns.values[1 + i].push_back(state[i] * (i % 3 == 2 ? 1.0 : units.length));
    };
    const integrate::Solution& solution = result.solution;
    for (std::size_t i = 0; i < solution.times.size(); ++i)
        add(solution.times[i], solution.states[i]);
    if (solution.times.empty() || solution.final_time > solution.times.back())
        add(solution.final_time, solution.final_state);
    return columns;
}

/// Component `which` of every rod as [T][N].
std::vector<double> interleaved(const Columns& columns, std::size_t rods, std::size_t which) {
    const std::size_t times = columns.values[0].size();
    std::vector<double> values;
    values.reserve(times * rods);
    for (std::size_t t = 0; t < times; ++t)
        for (std::size_t rod = 0; rod < rods; ++rod)
            values.push_back(columns.values[1 + 3 * rod + which][t]);
    return values;
}

void store_attributes(Session& session, const Case& one, const std::string& group, std::int64_t order) {
    store::Hdf5Writer& out = session.results;
    const rods::RodOutcome& outcome = one.result.outcome;
    const rods::Couplings c = couplings_of(one.scene);
    out.attribute(group, "label", one.label);
    out.attribute(group, "order", order);
    out.attribute(group, "outcome", rods::to_string(outcome.ending));
    out.attribute(group, "time", outcome.time * session.units.time);
    out.attribute(group, "min_separation", outcome.min_separation * session.units.length);
    out.attribute(group, "kappa", c.kappa);
    out.attribute(group, "gamma1", c.gamma1);
    out.attribute(group, "gamma2", c.gamma2);
    if (one.scene.medium) {
        out.attribute(group, "eta", one.scene.medium->eta);
        out.attribute(group, "alpha", 1.0 / one.scene.medium->xi);
    }
    if (one.scene.rods_run->contact_distance)
        out.attribute(group, "contact_distance",
                      *one.scene.rods_run->contact_distance * session.units.length);
}

void store(Session& session, const Case& one, std::int64_t order) {
    const std::size_t rods = one.scene.rods.size();
    const Columns columns = trajectory(one.result, rods, session.units);
    const std::size_t times = columns.values[0].size();
    const std::string group = "/rods/" + one.name;
    session.results.dataset(group + "/t", columns.values[0], {times}, session.units.time_name);
    session.results.dataset(group + "/x", interleaved(columns, rods, 0), {times, rods},
                            session.units.length_name);
    session.results.dataset(group + "/y", interleaved(columns, rods, 1), {times, rods},
                            session.units.length_name);
    session.results.dataset(group + "/theta", interleaved(columns, rods, 2), {times, rods}, "rad");
    store_attributes(session, one, group, order);
    session.directory.write(one.folder + "rods.csv", store::to_csv(columns.names, columns.values));
    session.directory.write(one.folder + "outcome.json",
                            outcome_json(one.result, one.options.ode, session.units));
}

StageEnd report(const Session& session, const Case& one) {
    const integrate::Status& status = one.result.solution.status;
    const std::string name = one.label.empty() ? std::string("rods") : "rods, " + one.label;
    if (status.outcome == integrate::Outcome::failed) {
        session.log->error("{}: {}", name, status.message());
        return StageEnd::failed;
    }
    session.log->info("{}: {} ({}); {} steps", name, rods::to_string(one.result.outcome.ending),
                      one.result.outcome.reason, one.result.solution.statistics.steps);
    return status.outcome == integrate::Outcome::interrupted ? StageEnd::interrupted : StageEnd::finished;
}

} // namespace

StageEnd run_rods_stage(Session& session) {
    std::vector<Case> cases = cases_of(session.modelled());
    parallel_for(cases.size(), session.options.threads,
                 [&](std::size_t i) { solve(session, cases[i], i == 0); });
    StageEnd end = StageEnd::finished;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        store(session, cases[i], static_cast<std::int64_t>(i));
        const StageEnd one = report(session, cases[i]);
        if (end == StageEnd::finished)
            end = one;
    }
    return end;
}

} // namespace rodwake::cli
