#include "fit_stage.hpp"

#include "fit_data.hpp"
#include "fit_json.hpp"
#include "fit_records.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "rodwake/scene/read.hpp"
#include "run/cost_parts.hpp"
#include "run/record_table.hpp"
#include "run/stage_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

/// Starts of the fit and blocks of the posterior alike: the work resumes from the journal, to which each item
/// is added when it is done.
template<class Method, class Item>
void resume(Method& method, std::function<void(const Item&)> Method::*on_done, store::Journal& journal,
            const RunContext& context, const Logger& log, const char* what, std::size_t total,
            const char* items) {
    method.threads = context.thread_count();
    method.stop_requested = [&context] { return context.stopped(); };
    method.done = journal.all<Item>();
    std::size_t count = method.done.size();
    if (count > 0)
        log->info("{}: resuming after {} of {} {}", what, count, total, items);
    Progress progress(context, what, static_cast<double>(total), items);
    method.*on_done = [&journal, count, progress](const Item& item) mutable {
        journal.add(item);
        progress.update(static_cast<double>(++count));
    };
}

} // namespace

std::string fit_key(const scene::Scene& scene, const FitPlan& plan) {
    scene::Scene only_fit;
    only_fit.fit = scene.fit;
    std::string key = build_info().version + " " + build_info().git + "\n" + scene::to_toml(only_fit);
    key += fmt::format("seed {}\n", plan.method.seed);
    for (const FitProfileData& p : plan.profiles)
        key += fmt::format("{}\n{}\n{}\n", fmt::join(p.data.place, " "), fmt::join(p.data.value, " "),
                           fmt::join(p.data.sigma, " "));
    for (const auto& [name, value] : plan.keys.fixed) // with drag_area
        key += fmt::format("{} {} {}\n", name, value,
                           plan.keys.fixed_errors.contains(name) ? plan.keys.fixed_errors.at(name) : 0.0);
    for (const FitMapData& m : plan.maps)
        key += fmt::format("{} {} {}\n{}\n{}\n{}\n{}\n{}\n{}\n", m.data.lx, m.data.ly, m.data.speed,
                           fmt::join(m.data.x, " "), fmt::join(m.data.y, " "), fmt::join(m.data.Ux, " "),
                           fmt::join(m.data.Uy, " "), fmt::join(m.data.sigma_x, " "),
                           fmt::join(m.data.sigma_y, " "));
    for (const FitTrackData& t : plan.tracks)
        for (std::size_t i = 0; i < t.data.times.size(); ++i)
            key += fmt::format("{} {}\n", t.data.times[i], fmt::join(t.data.states[i], " "));
    return key;
}

void forget_progress(const fs::path& folder) { fs::remove(folder / journal_file); }

FitStageResult fit_in_folder(const scene::Scene& scene, const FitPlan& plan, const RunContext& context,
                             const fs::path& folder, const Logger& log) {
    log_fit_data(plan, log);

    // Search from all starts.
    const std::string key = fmt::format("fit {}", std::hash<std::string>{}(fit_key(scene, plan)));
    store::Journal journal(folder / journal_file, key, store::Journal::OfAnother::replace);
    fitting::Method method = plan.method;
    resume(method, &fitting::Method::on_start_done, journal, context, log, "fit", method.starts, "starts");
    fitting::Fit fit = fitting::fit(plan.problem, method);
    method.on_start_done = nullptr;
    bool stopped = fit.termination == fitting::Termination::interrupted || context.stopped();
    if (!std::isfinite(fit.chi2) || fit.termination == fitting::Termination::failed) {
        if (!stopped)
            log->error("fit: failed: {}", fit.reason);
        return {stopped ? StageEnd::interrupted : StageEnd::failed, std::nullopt};
    }

    // Profile likelihoods. One that fails does not fail the fit, and one that was stopped is incomplete.
    FitResults results = fit_results(plan, std::move(fit));
    const auto& all = plan.problem.parameters;
    for (const std::string& name : plan.keys.likelihood) {
        if (stopped)
            break;
        const auto index = std::ranges::find(all, name, &fitting::Parameter::name) - all.begin();
        try {
            results.likelihood.emplace(name, fitting::profile_likelihood(plan.problem, method, results.fit,
                                                                         static_cast<std::size_t>(index)));
        } catch (const RunError& error) {
            log->warn("fit: no likelihood of {}: {}", name, error.what());
        }
        stopped = context.stopped();
        if (stopped)
            results.likelihood.erase(name);
    }

    // Errors by their cause, from refits. A refit that fails does not fail the fit.
    try {
        if (!stopped) {
            auto systematics = fit_systematics(plan, method, results);
            stopped = !systematics;
            if (systematics)
                results.systematics = std::move(*systematics);
        }
    } catch (const std::runtime_error& error) { // of a refit: the scene was checked before
        stopped = context.stopped();
        if (!stopped)
            log->warn("fit: no errors by their cause (held constants, masks, runs): {}", error.what());
    }

    write_fit(folder, plan, results, context.command);
    log_fit_results(plan, results, log);
    if (plan.keys.posterior && !stopped) {
        fitting::PosteriorMethod sampling = posterior_method(plan);
        resume(sampling, &fitting::PosteriorMethod::on_block_done, journal, context, log, "posterior",
               fitting::block_count(sampling), "blocks");
        const auto posterior = fitting::sample(plan.problem, fit_priors(plan), results.fit.values, sampling);
        stopped = !posterior;
        if (posterior) {
            write_posterior(folder, plan, *posterior, context);
            log_posterior(plan, *posterior, log);
        }
    }
    stopped = stopped || !add_models(scene, plan, results, context, folder, log);
    return {stopped ? StageEnd::interrupted : StageEnd::finished, std::move(results)};
}

StageEnd run_fit(Session& session) {
    const scene::Scene& scene = session.plan.scene;
    // Files that the run itself makes exist by now.
    const FitPlan plan =
        session.plan.fit_plan
            ? *session.plan.fit_plan
            : fit_plan(*scene.fit, read_fit_inputs(scene, session.directory.path(), OwnFiles::required));
    const FitStageResult done =
        fit_in_folder(scene, plan, session.context, session.directory.path(), session.log);
    if (done.end == StageEnd::finished)
        forget_progress(session.directory.path());
    const bool wanted = scene.medium && scene.medium->fitted;
    if (done.end == StageEnd::failed && wanted)
        throw RunError(
            "medium.fitted: the fit failed, so there is no medium for the rods and the field; give eta and "
            "xi in [medium] instead of fitted = true");
    if (done.end == StageEnd::finished && wanted)
        take_fitted_medium(session, *done.results, plan);
    return done.end;
}

namespace {

/// Seconds of one evaluation at the start, with its derivatives or without.
double evaluation_time(const fitting::Problem& problem, bool derivatives) {
    std::vector<double> start;
    for (const std::size_t i : fitting::free_parameters(problem))
        start.push_back(problem.parameters[i].start);
    const std::vector<double> values = fitting::all_values(problem, start);
    const auto rows = static_cast<Eigen::Index>(problem.residuals);
    Eigen::VectorXd residuals(rows);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(values.size()));
    return seconds_of([&] { problem.evaluate(values, residuals, derivatives ? &jacobian : nullptr); },
                      0.2 * cost_budget);
}

std::string fit_cost(const Plan& plan, const RunContext& context) {
    constexpr double evaluations = 50.0; // of a start with gradients
    const scene::Fit& keys = *plan.scene.fit;
    const double all = evaluations * static_cast<double>(keys.search.starts);
    std::string text = fmt::format("  fit: {} start{}, about {:.0f} evaluations of the model",
                                   keys.search.starts, keys.search.starts == 1 ? "" : "s", all);
    if (!plan.fit_plan)
        return text + "; their time is known when the run has made the data\n";
    const double each = evaluation_time(plan.fit_plan->problem, true);
    text += fmt::format(", {} residuals, about {}\n", plan.fit_plan->problem.residuals,
                        duration_text(all * each));
    if (!plan.fit_plan->keys.posterior)
        return text;
    const fitting::Problem& problem = plan.fit_plan->problem;
    const fitting::PosteriorMethod method = posterior_method(*plan.fit_plan);
    const std::size_t rivals = method.evidence ? plan.fit_plan->keys.models.size() : 0;
    const double count = fitting::evaluations(method, fitting::free_parameters(problem).size()) *
                         static_cast<double>(1 + rivals);
    const auto threads = static_cast<double>(std::min(method.chains, context.thread_count()));
    return text + fmt::format("  posterior: {} samples{}, about {:.0f} evaluations, {}\n", method.samples,
                              rivals > 0 ? fmt::format(" of each of {} models, for their evidence "
                                                       "(fit.posterior.evidence = false: of the fit alone)",
                                                       1 + rivals)
                                         : "",
                              count, duration_text(count * evaluation_time(problem, false) / threads));
}

std::vector<FileKind> fit_files() {
    using enum Lifetime;
    static const std::vector<ColumnInfo> models = [] {
        std::vector<ColumnInfo> all = {{"name", "1", "of the model"}};
        add_columns<FitModelRow>(all);
        return all;
    }();
    static const std::vector<ColumnInfo> columns = {
        {"runs", "1", "runs of the design"},
        {"information", "1", "expected information on which model makes the tracks, bits"},
        {"information_stderr", "1", "its standard error, bits"},
        {"right", "1", "fraction of sets in which the true model has the largest evidence"},
        {"least_log_bayes", "1",
         "least of all pairs: mean logarithm of the evidence ratio of the true model and another"}};
    return {
        {"fit.json", result, "parameters with errors, and how good the fit is", values_of<FitJson, true>()},
        {"medium.json", result, "the medium that the fit gives to field and rods"},
        {"fit_profile_<k>.csv", result, "a profile with its fit", columns_of<FitProfileRow>()},
        {"fit_curve_<k>.csv", result, "the model along a profile's line",
         columns_of<FitCurveRow, Each<FitComparison>>()},
        {"fit_map_<k>.csv", result, "a displacement map with its fit", columns_of<FitMapRow>()},
        {"fit_trajectory_<k>.csv", result, "rods with their fit",
         columns_of<FitTimeRow, Each<MeasuredPose>, Each<FittedPose>>()},
        {"posterior.json", result,
         "means, errors and quantiles of the parameters, how the chains mix, evidence"},
        {"posterior.csv", result, "samples of the parameters, by chain"},
        {"posterior.nc", result,
         "the same as ArviZ reads them: groups posterior, sample_stats, log_likelihood"},
        {"posterior_curve_<k>.csv", result, "predictions of the samples along a profile's line",
         columns_of<PredictedRow>()},
        {"posterior_trajectory_<k>.csv", result, "predictions of the samples for rods",
         columns_of<PredictedPoseRow>()},
        {"models.json", result,
         "model comparison: evidence, AIC and BIC, weights, and whether any model describes the data"},
        {"models.csv", result, "the same as a table", models},
        {"design.json", kept, "experiments that would discriminate between models, ranked by rodwake design"},
        {"design.csv", kept, "the same as a table, after the varied keys", columns},
        {journal_file, progress, "starts of the fit and blocks of the posterior that are done"}};
}

} // namespace

StageKind fit_stage() {
    return {.stage = Stage::fit,
            .has_table = [](const scene::Scene& s) { return s.fit.has_value(); },
            .wanted = [](const scene::Scene& s) { return s.fit.has_value(); },
            .key =
                [](const scene::Scene& s) {
                    scene::Scene key;
                    key.fit = s.fit;
                    return scene::to_plain_toml(key);
                },
            .files = fit_files,
            .read =
                [](PlanInputs& inputs, const scene::Scene& s, const InputRequest& request) {
                    inputs.fit = read_fit_inputs(s, request.folder,
                                                 request.check        ? OwnFiles::if_there
                                                 : request.made_later ? OwnFiles::left_out
                                                                      : OwnFiles::required);
                },
            .run = run_fit,
            .take_kept = take_stored_medium,
            .require =
                [](const Plan& plan, const fs::path& folder, const RunContext&) {
                    // If the folder holds beds, a fit alone must be of these.
                    if (plan.stages.size() == 1 && plan.scene.granular && !run_status(folder).empty())
                        require_same_beds(plan.scene, folder);
                },
            .cost = [](const Plan& plan, const fs::path&,
                       const RunContext& context) { return fit_cost(plan, context); },
            .outdated =
                [](const scene::Scene& s, const StageChanges& all) {
                    return (s.granular || s.tracks) &&
                           (all.redone(Stage::granular) || all.redone(Stage::measure));
                },
            .lacks =
                [](const fs::path& folder, const scene::Scene& s) {
                    return s.medium && s.medium->fitted && !fs::exists(folder / "medium.json");
                },
            .light = true};
}

} // namespace rodwake::app
