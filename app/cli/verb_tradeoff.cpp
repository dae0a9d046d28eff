// rodwake tradeoff: measures the settings of a scene, unless that is done already, and names the one asked
// for.

#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "signals.hpp"
#include "terminal.hpp"
#include "tradeoff_ways.hpp"
#include "values.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

namespace rodwake::cli {

namespace {

using app::ErrorKind;
using app::Trial;

/// --error, or the first kind. Throws InputError.
ErrorKind kind_of(const Options& options) {
    using enum ErrorKind;
    if (options.error_kind.empty())
        return final_state;
    std::vector<std::string> names;
    for (const ErrorKind kind : {final_state, contact_time, outcome, path})
        if (options.error_kind == names.emplace_back(to_string(kind)))
            return kind;
    std::string word = options.error_kind;
    throw InputError("--error: " + one_of(names)(word));
}

/// Absent without --for. An error of rods has no value that it could be a part of.
std::optional<double> error_wanted(const Options& options) {
    const auto wanted = wanted_error(options);
    if (wanted && (wanted->relative || !wanted->quantity.empty()))
        throw InputError(fmt::format(
            "--for \"{}\": of rods a plain number, such as 1e-6; --error says of what", options.want_error));
    return wanted ? std::optional(wanted->error) : std::nullopt;
}

double error_of(const Trial& trial, ErrorKind kind) { return trial.error[static_cast<std::size_t>(kind)]; }

std::string way_text(const app::Setting& s) {
    std::string text =
        fmt::format("{}, {}, {}", method_name(s), rods::to_string(s.form), app::name_of(s.field));
    if (s.table_tolerance > 0.0)
        text += fmt::format(" {:g}", s.table_tolerance);
    if (s.precision != elastic::Accuracy::full)
        text += ", " + app::name_of(s.precision);
    return text;
}

/// The settings that no other one beats.
void print_front(const app::Tradeoff& table, ErrorKind kind) {
    const auto front = pareto_front(table, kind);
    if (front.empty())
        throw RunError(
            fmt::format("no setting has a {}: the reference ends otherwise; --error names another kind",
                        to_string(kind)));
    fmt::print("{:>10}  {:>12}  {:>8}  {:>10}  {}\n", "error", "time", "rhs", "rtol", "method, form, field");
    for (const Trial* trial : front)
        fmt::print("{:>10.2g}  {:>12}  {:>8}  {:>10g}  {}\n", error_of(*trial, kind),
                   time_text(trial->seconds), trial->rhs_evaluations, trial->setting.tolerance,
                   way_text(trial->setting));
}

/// What to do where no setting is good enough.
std::string advice(const app::Tradeoff& table, ErrorKind kind, bool by_error) {
    const auto front = pareto_front(table, kind);
    if (front.empty())
        return fmt::format("no setting has a {}; --error names another kind", to_string(kind));
    const Trial& nearest = by_error ? *front.back() : *front.front();
    return fmt::format("the {} one has an error of {:.2g} and takes {}",
                       by_error ? "most accurate" : "fastest", error_of(nearest, kind),
                       time_text(nearest.seconds));
}

int answer(const Options& options, const scene::Scene& scene, const app::Tradeoff& table) {
    const ErrorKind kind = kind_of(options);
    const std::optional<double> error = error_wanted(options);
    if (!error && !options.want_time) {
        print_front(table, kind);
        return 0;
    }
    const Trial* best =
        error ? cheapest(table, kind, *error) : most_accurate(table, kind, *options.want_time);
    if (!best)
        throw RunError(fmt::format("no setting that was tried {}: {}",
                                   error ? fmt::format("has an error of {:g} or less", *error)
                                         : fmt::format("takes {} or less", time_text(*options.want_time)),
                                   advice(table, kind, error.has_value())));
    if (!options.quiet)
        tell(fmt::format("{} {:.2g}; {} for {}, {} right-hand sides\n", to_string(kind),
                         error_of(*best, kind), time_text(best->seconds), table.unit, best->rhs_evaluations));
    fmt::print("{}", scene_keys(scene, best->setting));
    return 0;
}

constexpr app::Stage only[] = {app::Stage::tradeoff};

/// 0, or the exit code of a measurement that did not come to its end.
int measure(const Options& options, const scene::Scene& scene, const std::filesystem::path& folder) {
    app::RunContext context = context_of(options);
    context.tradeoff = {kind_of(options), options.limit};
    const app::StageEnd end = app::run(app::plan_run(scene, only, folder, context), folder, context);
    if (end == app::StageEnd::interrupted)
        return signal_exit_code(stop_signal());
    make_figures(folder, false, true);
    return stop_signal() ? signal_exit_code(stop_signal()) : 0;
}

/// Whether the folder holds this measurement. Throws InputError if it is of other points: a list may change
/// where the scene does not.
bool is_done(const Options& options, const scene::Scene& scene, const std::filesystem::path& folder) {
    if (options.force || !app::holds_finished(folder, scene, app::Stage::tradeoff))
        return false;
    const app::Tradeoff table = app::read_tradeoff(folder);
    if (app::work_of(app::plan_run(scene, only, folder, {})) != table.work)
        throw InputError(folder.string() +
                         ": holds a measurement of other points of the scan; choose another folder "
                         "with -o, or --force to replace it");
    if (!options.quiet)
        tell(fmt::format("measured already in {}, with --limit {:g}s; --force measures anew\n",
                         folder.string(), table.limit));
    return true;
}

int describe_work(const scene::Scene& scene, const std::filesystem::path& folder) {
    const auto settings = app::settings_of(scene);
    fmt::print("{} settings would be timed, results in {}:\n", settings.size(), folder.string());
    for (const app::Setting& setting : settings)
        fmt::print("  rtol {:g}: {}\n", setting.tolerance, way_text(setting));
    return 0;
}

/// --of, or the first part that the scene names.
app::Part part_of(const Options& options, const scene::Scene& scene) {
    using enum app::Part;
    for (const app::Part part : {rods, bed, fit, field})
        if (options.tradeoff_of == to_string(part))
            return part;
    const bool foreign = scene.measure && !scene.measure->trajectory.empty();
    return scene.rods_run || scene.scan ? rods
           : scene.granular && !foreign ? bed
           : scene.fit                  ? fit
           : scene.field                ? field
                                        : rods;
}

int tradeoff_of_rods(const Options& options, const scene::Scene& scene) {
    const std::filesystem::path folder = output_folder(options);
    if (options.dry_run)
        return describe_work(scene, folder);
    kind_of(options);
    error_wanted(options);
    app::settings_of(scene); // refuses what cannot be measured
    const int code = is_done(options, scene, folder) ? 0 : measure(options, scene, folder);
    return code != 0 ? code : answer(options, scene, app::read_tradeoff(folder));
}

} // namespace

int verb_tradeoff(const Options& options) {
    scene::Scene scene = scene_of(options);
    if (options.seed)
        app::apply_seed(scene, *options.seed);
    const app::Part part = part_of(options, scene);
    return part == app::Part::rods ? tradeoff_of_rods(options, scene)
                                   : tradeoff_of_ways(options, scene, part);
}

} // namespace rodwake::cli
