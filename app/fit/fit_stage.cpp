#include "fit_stage.hpp"

#include "fit_data.hpp"
#include "fit_files.hpp"
#include "fit_records.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "rodwake/scene/read.hpp"
#include "run/cost_parts.hpp"
#include "run/log.hpp"
#include "run/record_table.hpp"
#include "run/stage_kind.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

std::string counted(std::size_t count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

/// All data in one line; their files only in log.txt.
void log_sources(const FitPlan& plan, const Logger& log) {
    std::vector<std::string> fitted, predicted;
    if (!plan.maps.empty()) {
        std::size_t used = 0, bins = 0;
        for (const FitMapData& m : plan.maps) {
            used += fitting::used_bins(m.data, plan.mask).size();
            bins += m.data.bins();
            log->debug("fit: map {}: {} of {} bins are fitted, {}", m.name,
                       fitting::used_bins(m.data, plan.mask).size(), m.data.bins(), m.file.string());
        }
        fitted.push_back(fmt::format("{} ({} of {} bins)", counted(plan.maps.size(), "map"), used, bins));
    }
    for (std::size_t i = 0; i < plan.profiles.size(); ++i) {
        const FitProfileData& p = plan.profiles[i];
        const bool fit = plan.keys.profiles[i].role == scene::FitRole::fit;
        (fit ? fitted : predicted)
            .push_back(fmt::format("profile {} ({})", p.name, counted(p.data.place.size(), "point")));
        log->debug("fit: profile {} from {}", p.name, p.file.string());
    }
    for (const FitTrackData& t : plan.tracks) {
        fitted.push_back(fmt::format("trajectory {} ({}, {})", t.name, counted(t.rods, "rod"),
                                     counted(t.data.times.size(), "row")));
        log->debug("fit: trajectory {} from {}", t.name, t.file.string());
    }
    log->info("fit: data: {}{}{}", fmt::join(fitted, ", "),
              predicted.empty() ? "" : "; to predict: ", fmt::join(predicted, ", "));
}

void log_data(const FitPlan& plan, const Logger& log) {
    log_sources(plan, log);
    for (const FitProfileData& p : plan.profiles)
        if (p.left_out > 0)
            log->warn("fit: {}: {} points without a sigma are left out", p.file.string(), p.left_out);
    for (const FitMapData& m : plan.maps) {
        if (m.left_out > 0)
            log->warn("fit: {}: {} bins without a sigma are left out", m.file.string(), m.left_out);
        if (m.mirrored)
            log->info("fit: {}: both sides hold the same numbers; y > 0 is fitted", m.file.string());
    }
    for (const FitTrackData& t : plan.tracks) {
        if (t.left_out > 0)
            log->info("fit: {}: {} rows with an unknown rod are left out", t.file.string(), t.left_out);
        if (t.unwrapped)
            log->info("fit: {}: headings that jump by half a turn were unwrapped", t.file.string());
    }
    for (const std::string& remark : plan.problem.remarks) // here too: the fit may fail of it
        log->warn("fit: {}", remark);
}

std::string with_unit(const std::string& unit) { return unit.empty() || unit == "1" ? "" : " " + unit; }

/// "eta = 2.18 +- 0.13" with the whole error: curvature, and what held constants, masks and runs add.
std::string line_of(const FitPlan& plan, const FitResults& results, std::size_t i) {
    const fitting::Report& r = results.report;
    const fitting::Estimate& e = r.estimates[i];
    const fitting::Parameter& p = plan.problem.parameters[i];
    const std::string value = fmt::format("{} = {:.6g}", e.name, e.value),
                      unit = with_unit(fit_unit(plan.keys, e.name));
    if (p.fixed)
        return value + unit + " (fixed)";
    if (e.at_lower || e.at_upper)
        return value + unit +
               fmt::format(" (at its {} bound), 95 % interval {:.5g} to {:.5g}",
                           e.at_lower ? "lower" : "upper", e.low, e.high);
    if (std::isfinite(e.standard_error))
        return fmt::format("{} +- {:.2g}{}", value, whole_error(results, e.name), unit);
    return value + unit + (std::isfinite(r.error_factor) ? ", not fixed by the data" : ", error unknown");
}

std::vector<std::string> value_lines(const FitPlan& plan, const FitResults& results) {
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < results.report.estimates.size(); ++i)
        lines.push_back(line_of(plan, results, i));
    for (const auto& [name, d] : results.derived)
        lines.push_back(fmt::format("{} = {:.6g}{}{}", name, d.value,
                                    d.not_fixed() ? ", not fixed by the data"
                                    : d.known()   ? fmt::format(" +- {:.2g}", whole_error(results, name))
                                    : std::isfinite(results.report.error_factor) ? ""
                                                                                 : ", error unknown",
                                    with_unit(fit_unit(plan.keys, name))));
    return lines;
}

/// Each parameter once; of maps, which have many, in one line.
void log_results(const FitPlan& plan, const FitResults& results, const Logger& log) {
    const fitting::Report& r = results.report;
    const std::vector<std::string> values = value_lines(plan, results);
    if (!results.systematics.total.empty())
        log->info("fit: {} (errors with those of held constants, masks and runs)", fmt::join(values, ", "));
    else
        for (const std::string& line : values)
            log->info("fit: {}", line);
    log->info("fit: chi2 = {:.4g} for {} degrees of freedom{}; {} of {} starts ended there", r.chi2, r.dof,
              misfit_text(results), r.same_optimum, results.fit.starts.size());
    log->debug("fit: {} ({})", to_string(results.fit.termination), results.fit.reason);
    for (const std::string& line : findings(plan, results))
        log->info("fit: {}", line);
    for (const std::string& line : comparisons(plan, results))
        log->debug("fit: {}", line);
    if (!r.diagnostics.empty())
        log->warn("fit: {}", fmt::join(r.diagnostics, "; "));
}

/// False if a signal stopped it. One that cannot be had does not take the fit with it.
bool add_likelihoods(const FitPlan& plan, const fitting::Method& method, FitResults& results,
                     const RunContext& context, const Logger& log) {
    const auto& all = plan.problem.parameters;
    for (const std::string& name : plan.keys.likelihood) {
        const auto at = std::ranges::find(all, name, &fitting::Parameter::name);
        try {
            results.likelihood.emplace(
                name, fitting::profile_likelihood(plan.problem, method, results.fit,
                                                  static_cast<std::size_t>(at - all.begin())));
        } catch (const RunError& error) {
            log->warn("fit: no likelihood of {}: {}", name, error.what());
        }
        if (context.stopped()) {
            results.likelihood.erase(name); // part of it
            return false;
        }
    }
    return true;
}

/// False if a signal stopped it. Refits that fail do not take the fit with them.
bool add_systematics(const FitPlan& plan, const fitting::Method& method, FitResults& results,
                     const Logger& log) {
    try {
        auto found = fit_systematics(plan, method, results);
        if (!found)
            return false;
        results.systematics = std::move(*found);
    } catch (const std::runtime_error& error) { // of a refit: the scene was checked before
        if (method.stop_requested && method.stop_requested())
            return false;
        log->warn("fit: no errors by their cause (held constants, masks, runs): {}", error.what());
    }
    return true;
}

fitting::Fit solve(const FitPlan& plan, fitting::Method& method, store::Journal& journal,
                   const RunContext& context, const Logger& log) {
    method.done = journal.all<fitting::StartResult>();
    if (!method.done.empty())
        log->info("fit: resuming after {} of {} starts", method.done.size(), method.starts);
    Progress progress(context, "fit", static_cast<double>(method.starts), "starts");
    std::size_t count = method.done.size();
    method.on_start_done = [&](const fitting::StartResult& end) {
        journal.add(end);
        progress.update(static_cast<double>(++count));
    };
    method.stop_requested = [&] { return context.stopped(); };
    fitting::Fit fit = fitting::fit(plan.problem, method);
    method.on_start_done = nullptr;
    return fit;
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
    log_data(plan, log);
    const std::string key = fmt::format("fit {}", std::hash<std::string>{}(fit_key(scene, plan)));
    store::Journal journal(folder / journal_file, key, store::Journal::OfAnother::replace);
    fitting::Method method = plan.method;
    method.threads = context.thread_count();
    fitting::Fit fit = solve(plan, method, journal, context, log);
    const bool failed = fit.termination == fitting::Termination::failed, usable = std::isfinite(fit.chi2);
    bool stopped = fit.termination == fitting::Termination::interrupted || context.stopped();
    if (!usable || failed) {
        if (!stopped)
            log->error("fit: failed: {}", fit.reason);
        return {stopped ? StageEnd::interrupted : StageEnd::failed, std::nullopt};
    }
    FitResults results = fit_results(plan, std::move(fit));
    stopped = stopped || !add_likelihoods(plan, method, results, context, log) ||
              !add_systematics(plan, method, results, log);
    write_fit(folder, plan, results, {context.command});
    log_results(plan, results, log);
    stopped = stopped || !add_posterior(plan, results.fit, journal, context, folder, log);
    stopped = stopped || !add_models(scene, plan, results, context, folder, log);
    return {stopped ? StageEnd::interrupted : StageEnd::finished, std::move(results)};
}

StageEnd run_fit(Session& session) {
    const scene::Scene& scene = session.plan.scene;
    // what the run makes is there by now
    const FitPlan plan =
        session.plan.fit_plan
            ? *session.plan.fit_plan
            : fit_plan(*scene.fit, read_fit_inputs(scene, session.directory.path(), OwnFiles::required));
    const FitStageResult done =
        fit_in_folder(session.plan.scene, plan, session.context, session.directory.path(), session.log);
    if (done.end == StageEnd::finished)
        forget_progress(session.directory.path());
    const bool wanted = session.plan.scene.medium && session.plan.scene.medium->fitted;
    if (done.end == StageEnd::failed && wanted)
        throw RunError(
            "medium.fitted: the fit failed, so there is no medium for the rods and the field; give eta and "
            "xi in [medium] instead of fitted = true");
    if (done.end == StageEnd::finished && wanted)
        take_fitted_medium(session, *done.results, plan);
    return done.end;
}

namespace {

struct FittedMedium {
    Estimate eta, xi, alpha, strength; ///< xi in f/mu
};

FittedMedium medium_of(const FitResults& results) {
    const fitting::Report& report = results.report;
    const double f = *fitted_value(report, "f_over_mu"), eta = *fitted_value(report, "eta");
    FittedMedium m;
    m.strength = derived(report, f, {{"f_over_mu", 1.0}});
    m.eta = derived(report, eta, {{"eta", 1.0}});
    if (const auto area = fitted_value(report, "drag_area")) {
        const Estimate alpha = results.derived.at("alpha");
        m.alpha = {alpha.value, whole_error(results, "alpha"), alpha.count};
        m.xi = {1.0 / alpha.value, m.alpha.error / (alpha.value * alpha.value), alpha.count};
        m.strength.error = whole_error(results, "f_over_mu");
        m.eta.error = whole_error(results, "eta");
    } else if (const auto alpha = fitted_value(report, "alpha")) {
        m.alpha = derived(report, *alpha, {{"alpha", 1.0}});
        m.xi = derived(report, 1.0 / *alpha, {{"alpha", -1.0 / (*alpha * *alpha)}});
    } else {
        const double xi = *fitted_value(report, "xi");
        m.alpha = derived(report, f / xi, {{"f_over_mu", 1.0 / xi}, {"xi", -f / (xi * xi)}});
        m.xi = derived(report, xi / f, {{"f_over_mu", -xi / (f * f)}, {"xi", 1.0 / f}});
    }
    return m;
}

void require_known(const FittedMedium& m, const fitting::Report& report) {
    const auto refuse = [](const std::string& what) {
        throw RunError(
            "medium.fitted: " + what +
            "; give eta and xi in [medium] instead of fitted = true, or fix one of them in fit.fixed");
    };
    if (!std::isfinite(report.error_factor))
        refuse("the errors of the fit are unknown");
    if (m.eta.not_fixed() || m.xi.not_fixed())
        refuse(fmt::format("the data do not fix {}", !m.eta.not_fixed()  ? "xi"
                                                     : !m.xi.not_fixed() ? "eta"
                                                                         : "eta and xi"));
    if (!(m.xi.value > 0.0) || !std::isfinite(m.xi.value))
        refuse(
            fmt::format("the fit gives f_over_mu = {:.4g} and with it xi = {:.4g} f/mu, which is no medium",
                        m.strength.value, m.xi.value));
}

nlohmann::ordered_json error_json(const Estimate& d) {
    return std::isfinite(d.error) ? nlohmann::ordered_json(d.error) : nlohmann::ordered_json(nullptr);
}

std::string medium_json(const FittedMedium& m, const std::string& length_unit) {
    const nlohmann::ordered_json json = {{"eta", m.eta.value},
                                         {"eta_stderr", error_json(m.eta)},
                                         {"xi", m.xi.value},
                                         {"xi_stderr", error_json(m.xi)},
                                         {"alpha", m.alpha.value},
                                         {"alpha_stderr", error_json(m.alpha)},
                                         {"f_over_mu_" + length_unit, m.strength.value},
                                         {"f_over_mu_" + length_unit + "_stderr", error_json(m.strength)},
                                         {"units", {{"eta", "1"}, {"xi", "f/mu"}, {"alpha", "1"}}}};
    return json_text(json, 2) + "\n";
}

std::string with_error(const char* name, const Estimate& d) {
    const std::string value = fmt::format("{} = {:.4g}", name, d.value);
    return d.known() ? value + fmt::format(" +- {:.2g}", d.error) : value;
}

/// What the medium is not to be trusted for.
void warn(const fitting::Report& report, const FitPlan& plan, const Logger& log) {
    for (const char* name : {"f_over_mu", "eta", "xi", "alpha"}) {
        const auto e = std::ranges::find(report.estimates, name, &fitting::Estimate::name);
        if (e != report.estimates.end() && at_bound(report, *e))
            log->warn("fitted medium: {0} = {1:.4g} lies at a bound of fit.bounds, so the data do not "
                      "determine it, and quantities derived from it have no error: widen fit.bounds.{0}, or "
                      "fix {0} in fit.fixed",
                      name, e->value);
    }
    if (plan.problem.sigma_known && report.dof > 0 && report.probability < 0.01)
        log->warn("fitted medium: the fit is poor, chi2 = {:.4g} for {} degrees of freedom: the medium may "
                  "be wrong by "
                  "more than its errors",
                  report.chi2, report.dof);
}

} // namespace

void take_fitted_medium(Session& session, const FitResults& results, const FitPlan& plan) {
    const FittedMedium m = medium_of(results);
    require_known(m, results.report);
    session.directory.write("medium.json", medium_json(m, plan.keys.length_unit));
    session.log->debug("fitted medium: {}, {} f/mu, {}", with_error("eta", m.eta), with_error("xi", m.xi),
                       with_error("alpha", m.alpha));
    warn(results.report, plan, session.log);
    session.use_medium(m.eta.value, m.xi.value);
}

std::pair<double, double> stored_medium(const std::filesystem::path& file) try {
    std::ifstream in(file);
    const auto json = nlohmann::json::parse(in);
    return {json.at("eta").get<double>(), json.at("xi").get<double>()};
} catch (const nlohmann::json::exception&) {
    throw InputError(file.string() + ": the medium of the earlier fit cannot be read; --force fits again");
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

std::string posterior_cost(const FitPlan& plan, const RunContext& context) {
    if (!plan.keys.posterior)
        return "";
    const fitting::PosteriorMethod method = posterior_method(plan);
    const double count = fitting::evaluations(method, fitting::free_parameters(plan.problem).size());
    const auto threads = static_cast<double>(std::min(method.chains, context.thread_count()));
    const std::size_t rivals = method.evidence ? plan.keys.models.size() : 0;
    const double all = count * static_cast<double>(1 + rivals);
    return fmt::format("  posterior: {} samples{}, about {:.0f} evaluations, {}\n", method.samples,
                       rivals > 0 ? fmt::format(" of each of {} models, for their evidence "
                                                "(fit.posterior.evidence = false: of the fit alone)",
                                                1 + rivals)
                                  : "",
                       all, duration_text(all * evaluation_time(plan.problem, false) / threads));
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
    return text +
           fmt::format(", {} residuals, about {}\n", plan.fit_plan->problem.residuals,
                       duration_text(all * each)) +
           posterior_cost(*plan.fit_plan, context);
}

std::span<const ColumnInfo> model_columns() {
    static const std::vector<ColumnInfo> columns = [] {
        std::vector<ColumnInfo> all = {{"name", "1", "of the model"}};
        add_columns<FitModelRow>(all);
        return all;
    }();
    return columns;
}

std::span<const ColumnInfo> design_columns() {
    static const std::vector<ColumnInfo> columns = {
        {"runs", "1", "runs of the design"},
        {"information", "1", "expected information on which model makes the tracks, bits"},
        {"information_stderr", "1", "its standard error, bits"},
        {"right", "1", "fraction of sets in which the true model has the largest evidence"},
        {"least_log_bayes", "1",
         "least of all pairs: mean logarithm of the evidence ratio of the true model and another"}};
    return columns;
}

std::vector<FileKind> fit_files() {
    using enum Lifetime;
    return {
        {"fit.json", result, "parameters with errors, and how good the fit is"},
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
        {"models.csv", result, "the same as a table", model_columns()},
        {"design.json", kept, "experiments that would discriminate between models, ranked by rodwake design"},
        {"design.csv", kept, "the same as a table, after the varied keys", design_columns()},
        {journal_file, progress, "starts of the fit and blocks of the posterior that are done"}};
}

/// A fit beside the beds of its scene: of these.
void require_same_beds_beside(const Plan& plan, const fs::path& folder, const RunContext&) {
    if (plan.stages.size() == 1 && plan.scene.granular && !run_status(folder).empty())
        require_same_beds(plan.scene, folder);
}

} // namespace

StageKind fit_stage() {
    return {.name = "fit",
            .has_table = [](const scene::Scene& s) { return s.fit.has_value(); },
            .wanted = [](const scene::Scene& s) { return s.fit.has_value(); },
            .key =
                [](const scene::Scene& s) {
                    scene::Scene key;
                    key.fit = s.fit;
                    return scene::to_plain_toml(key);
                },
            .files = fit_files,
            .run = run_fit,
            .require = require_same_beds_beside,
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
