#include "rods_checkpoint.hpp"
#include "rods_ensemble.hpp"
#include "rods_film.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "rodwake/medium/simulate.hpp"
#include "rodwake/rods/certificate.hpp"
#include "rodwake/scene/read.hpp"
#include "run/cost_parts.hpp"
#include "run/log.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"
#include "run/stage_kind.hpp"
#include "wake_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

/// A plan on its way.
struct Work {
    const RodsPlan* plan;
    rods::RodProblem problem; ///< the plan's, with its field
    rods::RodOptions options;
    rods::RodResult result;
    std::optional<rods::RodCheckpoint> end = {}; ///< from which a run with a later t_end goes on
    std::vector<double> own_turn;                ///< by own fields, where a dynamic medium tells them apart
    std::shared_ptr<const elastic::MeasuredDisplacement> measured; ///< with field = "measured"
    std::vector<rods::RodResult> samples; ///< in fields drawn from the measured one and its errors
    std::optional<rods::NoiseSums> noisy; ///< all runs with noise, of which `result` is the first
    std::unique_ptr<RodsFilm> film;       ///< with medium.dynamic.film_interval

    const Case& of() const { return plan->of; }
    /// A higher limit may follow a failure.
    bool is_over() const {
        const integrate::Status& status = result.solution.status;
        return status.ok() && status.termination != integrate::Termination::interrupted;
    }
    std::string checkpoint_file() const { return of().folder + "rods_checkpoint.rwc"; }
    std::string end_file() const { return of().folder + "rods_end.rwc"; }
    std::string rows_file() const { return of().folder + "rods.csv"; }
    /// Changes with the data of a measured field.
    std::string field_key() const {
        if (!measured)
            return {};
        const elastic::SmoothingReport &x = measured->report_x(), &y = measured->report_y();
        return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}", x.chi2, x.lambda, y.chi2, y.lambda);
    }
};

/// From the checkpoint of an interrupted run, else from the end of one with an earlier t_end.
void resume(const Session& session, Work& work) {
    for (const std::string& name : {work.checkpoint_file(), work.end_file()}) {
        const auto file = session.directory.file(name);
        if (session.context.force || !std::filesystem::exists(file))
            continue;
        auto checkpoint = read_checkpoint(file, work.of().scene, work.field_key());
        if (!checkpoint) {
            session.log->warn(
                "{}: damaged, or of another scene, field or version; starting from the beginning",
                file.string());
            continue;
        }
        const double earlier_end = checkpoint->time;
        const auto rows = session.directory.file(work.rows_file());
        if (name == work.end_file() && earlier_end < work.problem.t_end &&
            !take_rows(rows, session.units, *checkpoint)) {
            session.log->warn("{}: is not the table of the run that ended in {}; starting from the beginning",
                              rows.string(), name);
            continue;
        }
        work.options.resume_from =
            rods::carried_over(*std::move(checkpoint), work.problem, work.options.criteria);
        if (work.options.resume_from)
            return session.log->info("rods: {} at t = {:.6g}",
                                     name == work.end_file() ? "going on from the end of the earlier run"
                                                             : "resuming from the checkpoint",
                                     work.options.resume_from->time);
        if (earlier_end < work.problem.t_end)
            session.log->info(
                "rods: starting from the beginning, as the output times or the last part of the run differ");
    }
}

/// Takes up the film where the run is taken up; where its log is not as long, the run begins anew.
void open_film(const Session& session, Work& work) {
    const auto folder = session.directory.file(work.of().folder);
    std::filesystem::create_directories(folder);
    constexpr double none = -1.0;
    if (work.options.resume_from)
        try {
            work.film = std::make_unique<RodsFilm>(folder, *work.plan, work.options.resume_from->time);
            return;
        } catch (const InputError& error) {
            session.log->warn("{}; starting from the beginning", error.what());
            work.options.resume_from.reset();
        }
    work.film = std::make_unique<RodsFilm>(folder, *work.plan, none);
}

void solve(const Session& session, Work& work, bool show_progress) {
    Progress progress(session.context, "rods", work.plan->problem.t_end, "t");
    work.options.ode.stop_requested = [&] { return session.context.stopped(); };
    if (work.plan->noise) { // soon done again
        work.result = rods::simulate(work.problem, work.options, work.plan->noise->noise, 0);
        return;
    }
    if (show_progress)
        work.options.ode.on_step = [&](const integrate::Step& step) { progress.update(step.time); };
    work.options.on_checkpoint = [&](const rods::RodCheckpoint& checkpoint) {
        if (work.film)
            work.film->sync();
        session.directory.write(work.checkpoint_file(),
                                checkpoint_bytes(checkpoint, work.of().scene, work.field_key()));
    };
    // Two rods in steady wakes start at 0 again: they take milliseconds, and their certificate is of a whole
    // run. So do runs with a film, whose frames are in its file already.
    const auto& keys = work.of().scene.medium;
    const bool dynamic = keys && keys->is_dynamic();
    if (!(dynamic && keys->memory().film_interval) && (dynamic || !rods::to_pair_problem(work.problem)))
        work.options.on_end = [&](rods::RodCheckpoint end) { // whose other rows are in rods.csv
            end.times = {end.times.back()};
            end.outputs = {end.outputs.back()};
            work.end = std::move(end);
        };
    resume(session, work);
    if (dynamic) {
        const medium::DynamicMedium memory = keys->memory();
        medium::FilmSink sink;
        if (memory.film_interval) {
            open_film(session, work);
            sink = [&](const medium::FilmFrame& frame) { work.film->add(frame); };
        }
        medium::MediumResult result = medium::simulate({work.problem, memory}, work.options, sink);
        work.own_turn = std::move(result.own_turn);
        work.result = std::move(static_cast<rods::RodResult&>(result));
    } else
        work.result = rods::simulate_certified(work.problem, work.options);
    if (work.is_over())
        std::filesystem::remove(session.directory.file(work.checkpoint_file()));
}

/// In output units; the end of the run (contact, failure) is the last row.
struct TrajectoryTables {
    std::vector<TimeRow> times;
    std::vector<std::vector<PoseRow>> rods; ///< [rod][time]
};

/// Datasets t [T] and x, y, theta [T][N].
void store_trajectory(Session& session, const std::string& group, const TrajectoryTables& path) {
    const auto put = [&](const auto& field, const std::vector<double>& values,
                         const std::vector<std::size_t>& shape) {
        const std::string unit(field.info.unit);
        session.results.dataset(group + "/" + std::string(field.name), values, shape,
                                unit == "{time}"     ? session.units.time_name
                                : unit == "{length}" ? session.units.length_name
                                                     : unit);
    };
    const std::size_t times = path.times.size(), rods = path.rods.size();
    for_each_field<TimeRow>([&](const auto& field) {
        std::vector<double> values;
        for (const TimeRow& row : path.times)
            values.push_back(field.of(row));
        put(field, values, {times});
    });
    for_each_field<PoseRow>([&](const auto& field) {
        std::vector<double> values;
        values.reserve(times * rods);
        for (std::size_t t = 0; t < times; ++t)
            for (const std::vector<PoseRow>& rod : path.rods)
                values.push_back(field.of(rod[t]));
        put(field, values, {times, rods});
    });
}

void store_attributes(Session& session, const Work& work, const std::string& group, std::int64_t order) {
    store::Hdf5Writer& out = session.results;
    const rods::RodOutcome& outcome = work.result.outcome;
    out.attribute(group, "label", work.of().label);
    out.attribute(group, "order", order);
    out.attribute(group, "outcome", to_string(outcome.ending));
    out.attribute(group, "certificate", to_string(outcome.certificate));
    out.attribute(group, "time", outcome.time * session.units.time);
    out.attribute(group, "min_separation", outcome.min_separation * session.units.length);
    write_couplings(out, group, work.of().scene.coupling.value_or(scene::Coupling{}), session.units);
    if (work.of().scene.medium) {
        out.attribute(group, "field", to_string(field_of(*work.plan)));
        out.attribute(group, "eta", work.of().scene.medium->eta);
        out.attribute(group, "alpha", 1.0 / work.of().scene.medium->xi);
    }
    if (work.of().scene.rods_run->contact_distance)
        out.attribute(group, "contact_distance",
                      *work.of().scene.rods_run->contact_distance * session.units.length);
}

void store(Session& session, Work& work, std::int64_t order) {
    const std::size_t rods = work.of().scene.rods.size();
    TrajectoryTables path{{}, std::vector<std::vector<PoseRow>>(rods)};
    const auto add = [&](double time, const std::vector<double>& state) {
        path.times.push_back({time * session.units.time});
        for (std::size_t rod = 0; rod < rods; ++rod)
            path.rods[rod].push_back({state[3 * rod] * session.units.length,
                                      state[3 * rod + 1] * session.units.length, state[3 * rod + 2]});
    };
    const integrate::Solution& solution = work.result.solution;
    for (std::size_t i = 0; i < solution.times.size(); ++i)
        add(solution.times[i], solution.states[i]);
    if (solution.times.empty() || solution.final_time > solution.times.back())
        add(solution.final_time, solution.final_state);
    const std::string group = "/rods/" + work.of().name;
    store_trajectory(session, group, path);
    store_bodies(session.results, group, work.problem, session.units);
    store_attributes(session, work, group, order);
    RecordTable table;
    table.add(path.times);
    for (std::size_t rod = 0; rod < path.rods.size(); ++rod)
        table.add(path.rods[rod], std::to_string(rod));
    session.directory.write(work.rows_file(), table.csv());
    if (work.end)
        session.directory.write(work.end_file(),
                                checkpoint_bytes(*work.end, work.of().scene, work.field_key()));
    std::optional<DrawnReport> drawn;
    if (!work.samples.empty())
        drawn = drawn_report(work.samples, work.problem.box, session.units);
    session.directory.write(work.of().folder + "outcome.json",
                            outcome_json(work.result, *work.plan, session.units, drawn, work.own_turn));
    if (work.noisy) {
        session.directory.write(work.of().folder + "noise.json",
                                noise_json(*work.noisy, *work.plan->noise, work.problem, session.units));
        session.directory.write(work.of().folder + "ensemble.csv",
                                noise_csv(*work.noisy, rods, session.units));
    }
    if (work.film) {
        work.film->write(session.units, session.context.command);
        if (work.is_over())
            work.film->remove_log();
    }
    if (work.samples.empty())
        return;
    store_ensemble(session.results, group + "/ensemble", work.samples, work.problem.output_times,
                   session.units);
    session.directory.write(work.of().folder + "ensemble.csv",
                            ensemble_csv(work.samples, work.problem.box, session.units));
}

/// Threads that the cases leave over add up the wakes of each.
Work work_of(const RodsPlan& plan, WakeFields& fields, std::size_t threads) {
    Work work{&plan, plan.problem, plan.options, {}, {}, {}, nullptr, {}, {}, nullptr};
    const rods::RodProblem& problem = plan.problem;
    const auto& medium = plan.of.scene.medium;
    work.problem.sums.threads =
        medium && medium->is_dynamic()
            ? medium::worthwhile_threads(medium->memory(), problem.rods.size(), threads)
            : threads;
    if (!(problem.medium && problem.couplings.any() && (problem.rods.size() > 1 || problem.box)))
        return work;
    if (medium->field != scene::FieldBackend::exact && !medium->is_dynamic())
        work.problem.field = fields.of(plan.of.scene);
    if (medium->field == scene::FieldBackend::measured)
        work.measured = fields.measured(plan.of.scene);
    return work;
}

/// One case after the other, each over all threads.
StageEnd solve_noise(const Session& session, std::vector<Work>& cases) {
    StageEnd end = StageEnd::finished;
    for (Work& work : cases) {
        if (!work.plan->noise)
            continue;
        rods::NoiseSums sums;
        if (!run_noise(session, *work.plan, work.problem, work.field_key(), sums))
            return StageEnd::interrupted;
        const auto failed = std::ranges::count_if(sums.ends, &rods::NoisyEnd::failed);
        if (failed > 0) {
            session.log->error("noise{}: {} of {} runs failed, the first: {}", work.of().suffix(), failed,
                               sums.ends.size(), sums.failure);
            end = StageEnd::failed; // the folder stays open for another try
        }
        // The log gives the probability of capture. It is a warning where noise.most_runs, not a failed run,
        // left the interval too wide. A single rod captures none.
        if (const scan::Proportion captures = captured(sums, work.problem.rods.size()); captures.of > 0) {
            const auto [low, high] = captures.wilson(capture_quantile);
            session.log->info(
                "noise{}: {} of {} runs end in contact or pursuit, capture probability {:.3g} ({:.3g} to "
                "{:.3g} with 95 % confidence)",
                work.of().suffix(), captures.count, captures.of, captures.value(), low, high);
            const NoisePlan& plan = *work.plan->noise;
            const bool wide = plan.capture_error && (high - low) / 2.0 > *plan.capture_error;
            if (wide && sums.ends.size() >= plan.most_runs)
                session.log->warn("noise{}: stopped at noise.most_runs = {} before the error of the capture "
                                  "probability fell to noise.capture_error = {:g}",
                                  work.of().suffix(), plan.most_runs, *plan.capture_error);
        }
        work.noisy = std::move(sums);
    }
    return end;
}

StageEnd run_rods(Session& session) {
    // a medium from [fit] is known only now
    const std::vector<RodsPlan> fitted =
        session.fitted() ? plan_rods(session.modelled()) : std::vector<RodsPlan>{};
    WakeFields fields(session);
    const std::vector<RodsPlan>& plans = session.fitted() ? fitted : session.plan.rods;
    const std::size_t threads = std::max<std::size_t>(1, session.context.thread_count() / plans.size());
    std::vector<Work> cases;
    cases.reserve(plans.size());
    for (const RodsPlan& plan : plans)
        cases.push_back(work_of(plan, fields, threads));
    parallel_for(cases.size(), session.context.thread_count(),
                 [&](std::size_t i) { solve(session, cases[i], i == 0); });
    // Samples of the field's errors: one case after the other, each over all threads.
    StageEnd end = StageEnd::finished;
    for (Work& work : cases) {
        const auto& keys = work.of().scene.medium;
        if (!work.measured || keys->measured->samples == 0)
            continue;
        work.samples =
            run_ensemble(work.problem, work.options, *work.measured, *keys->measured, session.context);
        if (work.samples.empty()) {
            end = StageEnd::interrupted;
            break;
        }
        session.log->info("rods: {} samples of the measured field's errors", work.samples.size());
    }
    if (end == StageEnd::finished)
        end = solve_noise(session, cases);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        store(session, cases[i], static_cast<std::int64_t>(i));
        const Case& of = cases[i].of();
        const rods::RodResult& result = cases[i].result;
        const integrate::Status& status = result.solution.status;
        const std::string name = of.label.empty() ? std::string("rods") : "rods, " + of.name;
        StageEnd of_case = StageEnd::finished;
        if (status.termination == integrate::Termination::failed) {
            session.log->error("{}: {}", name, status.message());
            of_case = StageEnd::failed;
        } else {
            session.log->info("{}: {} ({}); {}, {} steps", name, to_string(result.outcome.ending),
                              result.outcome.reason, to_string(result.outcome.certificate),
                              result.solution.statistics.steps);
            if (status.termination == integrate::Termination::interrupted)
                of_case = StageEnd::interrupted;
        }
        if (end == StageEnd::finished)
            end = of_case;
    }
    return end;
}

std::vector<FileKind> rods_files() {
    using enum Lifetime;
    return {{"rods.csv", kept, "rods against time", columns_of<TimeRow, Each<PoseRow>>()},
            {"outcome.json", result, "how the encounter ended, and what the solver did",
             values_of<OutcomeReport>()},
            {"ensemble.csv", result,
             "one row per run with noise, or per draw of the measured field's errors: its outcome",
             columns_of<DrawnRow, NoisyRow>()},
            {"noise.json", result,
             "ensemble of runs with noise: probability of capture (contact, bound, orbit or pursuit) with "
             "its 95 % "
             "interval, outcomes, first contact; mean-square displacement and heading correlation of each "
             "rod against time",
             values_of<NoiseReport>()},
            {"medium_film.h5", result,
             "frames of a dynamic medium: its displacement u on a grid, the sum of the fields of all rods, "
             "also where each rod feels the other rods alone; with positions and headings of the rods"},
            {"medium_film.log", progress, "frames so far"},
            {"noise.log", progress, "finished runs with noise, to resume from"},
            {"rods_end.rwc", kept, "state at t_end, from which a run with a later t_end goes on"},
            {"rods_checkpoint.rwc", progress, "state to resume from"}};
}

/// Runs, and the time of a right-hand side at the start. A step of a dynamic medium has no part that could be
/// timed by itself.
std::string rods_cost(const Plan& plan) {
    std::string text;
    for (const RodsPlan& rods_plan : plan.rods) {
        const auto& medium = rods_plan.of.scene.medium;
        double runs = rods_plan.noise ? static_cast<double>(rods_plan.noise->runs) : 1.0;
        if (field_of(rods_plan) == scene::FieldBackend::measured)
            runs += static_cast<double>(medium->measured->samples);
        text += fmt::format("  rods{}: {:g} run{} to t = {:g}", rods_plan.of.suffix(), runs,
                            runs == 1.0 ? "" : "s", rods_plan.of.scene.rods_run->t_end);
        if (rods_plan.noise && rods_plan.noise->capture_error)
            text += fmt::format(", up to {} for noise.capture_error", rods_plan.noise->most_runs);
        if (medium && medium->is_dynamic()) {
            text += "; steps of a dynamic medium are not timed\n";
            continue;
        }
        rods::RodProblem problem = rods_plan.problem;
        problem.field = nullptr;
        const rods::RodModel model = rods::model_of(problem);
        const std::vector<double> y = rods::to_state(problem.rods);
        std::vector<double> ydot(y.size());
        try {
            const double seconds = seconds_of([&] { model.rhs(y, ydot); }, 0.1 * cost_budget);
            text +=
                fmt::format(", {} for a right-hand side{}\n", duration_text(seconds),
                            field_of(rods_plan) == scene::FieldBackend::exact ? "" : " in the exact field");
        } catch (const InputError&) { // rods that start in contact never ask for it
            text += "; not timed, as the field is singular where the rods start\n";
        }
    }
    return text;
}

/// Whether the same rods run to another end, or have rows at other times.
bool runs_on(const scene::Scene& old, const scene::Scene& scene) {
    return scene.rods_run->t_end != old.rods_run->t_end ||
           scene.rods_run->output_times != old.rods_run->output_times;
}

} // namespace

StageKind rods_stage() {
    return {.stage = Stage::rods,
            .has_table = [](const scene::Scene& s) { return s.rods_run.has_value(); },
            .wanted = [](const scene::Scene& s) { return s.rods_run.has_value(); },
            .key =
                [](const scene::Scene& s) {
                    scene::Scene key = key_of_rods(s);
                    if (key.rods_run) {
                        key.rods_run->t_end = scene::RodsRun{}.t_end;
                        key.rods_run->output_times.clear();
                        key.rods_run->t_end_from_outputs = false;
                    }
                    return scene::to_plain_toml(key);
                },
            .files = rods_files,
            .read = read_field_file,
            .run = run_rods,
            .cost = [](const Plan& plan, const std::filesystem::path&,
                       const RunContext&) { return rods_cost(plan); },
            .outdated = has_new_field,
            .grows = runs_on,
            .conflicts =
                [](const scene::Scene& old, const scene::Scene& s, bool asked) {
                    return asked ? s.rods_run->t_end < old.rods_run->t_end : runs_on(old, s);
                },
            .datasets = true};
}

} // namespace rodwake::app
