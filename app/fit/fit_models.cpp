// Rivals of a fit, [[fit.models]]: each fitted to the same data, and all of them weighed.

#include "fit_data.hpp"
#include "fit_json.hpp"
#include "fit_records.hpp"
#include "fit_stage.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

/// A model with its estimates, or the reason why its fit failed.
struct WeighedModel {
    std::string name, folder; ///< folder: from the run's on, "." for the fit as written
    std::string failure;
    std::vector<fitting::ParameterEstimate> estimates; ///< of the free parameters
    fitting::Misfit misfit;
    std::optional<fitting::CrossValidation> foretold;
    FitModelRow row;

    bool ended() const { return failure.empty(); }
};

WeighedModel weighed(const FitPlan& plan, const FitResults& results, const RunContext& context,
                     const fs::path& folder, const std::string& name, const std::string& own,
                     const Logger& log) {
    WeighedModel out{name, own, {}, {}, results.misfit, {}, {}};
    for (const std::size_t i : results.report.free)
        out.estimates.push_back(results.report.estimates[i]);
    out.row.parameters = static_cast<double>(results.report.free.size());
    out.row.chi2 = results.report.chi2;
    out.row.dof = static_cast<double>(results.report.dof);

    // AIC and BIC from -2 ln L, up to a constant that all models of the data share: chi2, or for unknown
    // sigmas the value at their best scale, which is a parameter, too.
    const auto values = static_cast<double>(fitting::independent_values(plan.problem));
    const bool known = plan.problem.sigma_known;
    const double free = out.row.parameters + (known ? 0.0 : 1.0),
                 minus_2_log_l = known ? results.fit.objective - static_cast<double>(plan.problem.log_scales)
                                       : values * std::log(results.fit.objective / values);
    out.row.aic = minus_2_log_l + 2.0 * free;
    out.row.bic = minus_2_log_l + free * std::log(values);

    out.row.misfit = out.misfit.probability.value_or(std::nan(""));
    // The evidence stands in posterior.json. Remarks of a rival are repeated: its log is not on the terminal.
    if (plan.keys.posterior) {
        std::ifstream file(folder / own / "posterior.json");
        const auto json = nlohmann::json::parse(file, nullptr, false);
        if (json.is_object() && json.contains("log_evidence") && json["log_evidence"].is_object()) {
            const auto& evidence = json["log_evidence"];
            const auto number = [&](const char* key) {
                return evidence.contains(key) && evidence[key].is_number() ? evidence[key].get<double>()
                                                                           : std::nan("");
            };
            out.row.log_evidence = number("value");
            out.row.evidence_error = number("stderr");
            if (own != "." && !name.empty() && json.contains("remarks"))
                for (const auto& remark : json["remarks"])
                    log->warn("posterior of model {}: {}", name, remark.get<std::string>());
        }
    }

    fitting::Method method = plan.method;
    method.threads = context.thread_count();
    method.stop_requested = [&] { return context.stopped(); };
    try {
        out.foretold = fitting::cross_validate(plan.problem, method, results.fit);
    } catch (const RunError& error) {
        if (!context.stopped())
            log->warn("fit: model {}: no cross-validation: {}", name, error.what());
    }
    return out;
}

std::string probability_text(double p) { return p < 0.001 ? "p < 0.001" : fmt::format("p = {:.2g}", p); }

std::string weight_text(const WeighedModel& m) {
    return m.row.weight > 0.0 && m.row.weight < 0.001 ? "below 0.001" : fmt::format("{:.3g}", m.row.weight);
}

/// The models' order by weight, those that failed last.
std::vector<std::size_t> by_weight(const std::vector<WeighedModel>& models) {
    std::vector<std::size_t> order(models.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        return std::pair(models[a].ended(), models[a].row.weight) >
               std::pair(models[b].ended(), models[b].row.weight);
    });
    return order;
}

/// Sentences of the verdict, which the abstract of the report repeats.
std::vector<std::string> verdict(const std::vector<WeighedModel>& models, bool evidence) {
    const std::vector<std::size_t> order = by_weight(models);
    const WeighedModel &best = models[order[0]], &next = models[order[1]];
    std::vector<std::string> text = {fmt::format(
        "Of {} models {} has the most weight, {} by {}; next is {} with {}.", models.size(), best.name,
        weight_text(best), evidence ? "evidence" : "AIC", next.name, weight_text(next))};
    std::vector<std::string> describing;
    bool all_tested = true;
    for (const std::size_t i : order) {
        const WeighedModel& m = models[i];
        all_tested = all_tested && (!m.ended() || m.misfit.probability);
        if (m.ended() && m.misfit.probability && m.misfit.describes())
            describing.push_back(fmt::format("{} ({})", m.name, probability_text(*m.misfit.probability)));
    }
    if (!describing.empty())
        text.push_back(fmt::format("The data are described by {}.", fmt::join(describing, ", ")));
    else if (all_tested && best.misfit.probability)
        text.push_back(fmt::format("No model offered describes the data: with {}, {} ({}).", best.name,
                                   best.misfit.worst, probability_text(*best.misfit.probability)));
    return text;
}

void write_models(const fs::path& folder, const FitPlan& plan, const std::vector<WeighedModel>& models,
                  bool evidence, const std::vector<std::string>& text, const std::string& command) {
    ordered_json out = {{"models", ordered_json::array()}};
    std::vector<FitModelRow> rows;
    for (const WeighedModel& m : models) {
        ordered_json model = {{"name", m.name}};
        model.update(record_json(m.row));
        model["stderr"] = model["log_evidence_stderr"];
        model["parameters"] = ordered_json::object();
        for (const fitting::ParameterEstimate& e : m.estimates)
            model["parameters"][e.name] = {{"value", finite_or_null(e.value)},
                                           {"stderr", finite_or_null(e.standard_error)}};
        model["free"] = m.estimates.size();
        model["cross_validation"] = nullptr;
        if (m.foretold)
            model["cross_validation"] = {{"log_likelihood", finite_or_null(m.row.foretold)},
                                         {"stderr", finite_or_null(m.row.foretold_error)},
                                         {"difference", finite_or_null(m.row.foretold_difference)},
                                         {"difference_stderr", finite_or_null(m.row.difference_error)},
                                         {"blocks", m.foretold->blocks.size()}};
        model["misfit"] = record_json(MisfitEntry{m.misfit});
        model["failure"] = m.ended() ? ordered_json(nullptr) : ordered_json(m.failure);
        model["folder"] = m.folder;
        out["models"].push_back(model);
        rows.push_back(m.row);
    }
    out["weight_from"] = evidence ? "evidence" : "aic";
    out["values"] = fitting::independent_values(plan.problem);
    out["sigma_known"] = plan.problem.sigma_known;
    out["text"] = text;
    out["provenance"] = {{"command", command}, {"version", build_info().version}, {"git", build_info().git}};
    std::string csv = csv_of(rows), named;
    std::size_t line = 0;
    for (std::size_t at = 0; at < csv.size(); ++line) { // names are file names: nothing to quote
        const std::size_t end = csv.find('\n', at) + 1;
        named += (line == 0 ? "name" : models[line - 1].name) + "," + csv.substr(at, end - at);
        at = end;
    }
    store::write_atomically(folder / "models.csv", named);
    store::write_atomically(folder / "models.json", json_text(out, 2) + "\n");
}

void log_models(const std::vector<WeighedModel>& models, const std::vector<std::string>& text,
                const Logger& log) {
    for (const std::size_t i : by_weight(models)) {
        const WeighedModel& m = models[i];
        if (!m.ended()) {
            log->warn("fit: model {} failed: {}", m.name, m.failure);
            continue;
        }
        std::string evidence;
        if (std::isfinite(m.row.log_evidence))
            evidence =
                fmt::format(", log evidence {:.5g} +- {:.2g}", m.row.log_evidence, m.row.evidence_error);
        log->info("fit: model {}: weight {}, chi2 = {:.4g} for {} parameters, AIC {:.5g}, BIC {:.5g}{}{}",
                  m.name, weight_text(m), m.row.chi2, m.estimates.size(), m.row.aic, m.row.bic, evidence,
                  m.misfit.probability ? ", misfit " + probability_text(*m.misfit.probability) : "");
    }
    for (const std::string& sentence : text)
        log->info("fit: {}", sentence);
}

} // namespace

FitPlan model_plan(const scene::Scene& scene, const scene::FitModel& model, const FitPlan& plan,
                   FitInputs inputs) try {
    FitPlan rival = fit_plan(*scene::apply_model(scene, model).fit, std::move(inputs));
    // Only fits of the same data in the same weights can be compared.
    const fitting::Problem &a = plan.problem, &b = rival.problem;
    const bool sigmas = std::ranges::equal(a.log_sigma, b.log_sigma, [](double s, double t) {
        return std::abs(s - t) < 1e-9 * (1.0 + std::abs(s));
    });
    if ((a.log_scales == 0) != (b.log_scales == 0))
        throw InputError(
            fmt::format("fit.models {}: rods diffuse (D_r, D_t) in one of it and the fit as written and "
                        "not in the other: hold D_r = 0 in fit.fixed of the one without",
                        model.name));
    if (a.residuals != b.residuals || a.independent != b.independent || a.sigma_known != b.sigma_known ||
        !sigmas)
        throw InputError(fmt::format("fit.models {}: it has {} residuals and the fit itself {}{}: models can "
                                     "only be compared on the same data",
                                     model.name, b.residuals, a.residuals,
                                     sigmas ? "" : ", or their errors differ"));
    if (rival.keys.posterior && !rival.keys.posterior->evidence) // it is sampled for its evidence alone
        rival.keys.posterior.reset();
    return rival;
} catch (const InputError& error) {
    const std::string text = error.what();
    throw InputError(text.starts_with("fit.models") ? text
                                                    : fmt::format("fit.models {}: {}", model.name, text));
}

bool add_models(const scene::Scene& scene, const FitPlan& plan, const FitResults& results,
                const RunContext& context, const fs::path& folder, const Logger& log) {
    if (plan.keys.models.empty())
        return true;
    RunContext quiet = context; // messages of a rival go to the log in its folder only
    quiet.log = nullptr;
    std::vector<WeighedModel> models = {weighed(plan, results, context, folder, plan.keys.name, ".", log)};
    for (const scene::FitModel& model : plan.keys.models) {
        const scene::Scene rival = scene::apply_model(scene, model);
        const FitPlan own =
            model_plan(scene, model, plan, read_fit_inputs(rival, folder, OwnFiles::required));
        const std::string path = "models/" + model.name;
        fs::create_directories(folder / path);
        const FitStageResult done =
            fit_in_folder(rival, own, context, folder / path, make_logger(quiet, folder / path / "log.txt"));
        if (done.end == StageEnd::interrupted)
            return false;
        if (done.results)
            models.push_back(weighed(own, *done.results, context, folder, model.name, path, log));
        else
            models.push_back({model.name, path, "the search found no finite residuals", {}, {}, {}, {}});
        if (context.stopped())
            return false;
    }
    // Weights in proportion to exp(score): of the evidence if all models that ended have it, else of AIC.
    const bool evidence = std::ranges::all_of(
        models, [](const WeighedModel& m) { return !m.ended() || std::isfinite(m.row.log_evidence); });
    const auto score = [&](const WeighedModel& m) {
        return !m.ended() ? -HUGE_VAL : evidence ? m.row.log_evidence : -0.5 * m.row.aic;
    };
    double best = -HUGE_VAL, sum = 0.0;
    for (const WeighedModel& m : models)
        best = std::max(best, score(m));
    for (const WeighedModel& m : models)
        sum += std::exp(score(m) - best);
    for (WeighedModel& m : models)
        m.row.weight = std::exp(score(m) - best) / sum;
    // Log-likelihoods of cross-validation, and their differences from the best model, stretch by stretch.
    const std::optional<fitting::CrossValidation> of_best = models[by_weight(models).front()].foretold;
    for (WeighedModel& m : models) {
        if (!m.foretold)
            continue;
        m.row.foretold = m.foretold->sum();
        m.row.foretold_error = m.foretold->error();
        if (!of_best || of_best->blocks.size() != m.foretold->blocks.size())
            continue;
        fitting::CrossValidation difference = *m.foretold;
        for (std::size_t i = 0; i < difference.blocks.size(); ++i)
            difference.blocks[i] -= of_best->blocks[i];
        m.row.foretold_difference = difference.sum();
        m.row.difference_error = difference.error();
    }
    const std::vector<std::string> text = verdict(models, evidence);
    write_models(folder, plan, models, evidence, text, context.command);
    log_models(models, text, log);
    if (plan.keys.posterior && plan.keys.posterior->evidence && !evidence)
        log->warn("fit: not every model has an evidence, so the weights are computed from AIC");
    for (const WeighedModel& m : models)
        forget_progress(folder / m.folder);
    return true;
}

} // namespace rodwake::app
