// rodwake tradeoff: measures the settings of a scene, unless that is done already, and names the one asked
// for.

#include "definition.hpp"
#include "options.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>

namespace rodwake::cli {

namespace {

/// --for: "1e-6", "2%", "rod_speed 2%".
struct WantedError {
    std::string quantity; ///< empty: that of --error
    double error = 0.0;
    bool relative = false; ///< in parts of the quantity itself: 2 % is 0.02
};

/// Nothing without --for. Throws InputError for what is no error.
std::optional<WantedError> wanted_error(const Options& options) {
    const std::string& text = options.want_error;
    if (text.empty())
        return std::nullopt;
    WantedError wanted;
    const auto space = text.find_last_of(' ', text.find_last_not_of(" %"));
    std::string number = space == std::string::npos ? text : text.substr(space + 1);
    if (space != std::string::npos)
        wanted.quantity = text.substr(0, text.find_last_not_of(' ', space) + 1);
    number.erase(number.find_last_not_of(' ') + 1);
    wanted.relative = number.ends_with('%');
    if (wanted.relative)
        number.erase(number.find_last_not_of(" %") + 1);
    if (const std::string wrong = number_from(0.0, std::numeric_limits<double>::max())(number);
        !wrong.empty())
        throw InputError("--for: " + wrong);
    wanted.error = std::stod(number);
    wanted.error *= wanted.relative ? 0.01 : 1.0;
    return wanted;
}

std::string time_text(double seconds) {
    return seconds < 1e-3    ? fmt::format("{:.3g} us", 1e6 * seconds)
           : seconds < 1.0   ? fmt::format("{:.3g} ms", 1e3 * seconds)
           : seconds < 600.0 ? fmt::format("{:.3g} s", seconds)
                             : fmt::format("{:.3g} h", seconds / 3600.0);
}

// A bed, a fit or a field map: measured once, answered from then on.

using app::Choice;
using app::Found;
using app::Tradeoff;
using app::Way;

/// Of what the answer is about.
std::string quantity_of(const Options& options, const Tradeoff& ways) {
    const auto wanted = wanted_error(options);
    if (wanted && !wanted->quantity.empty())
        return wanted->quantity;
    if (!options.error_kind.empty())
        return options.error_kind;
    const auto names = quantities_of(ways);
    return names.empty() ? "" : names.front();
}

/// Errors of fits and fields are errors already; of beds they are told as parts of the value.
bool scatters(const Found& found) { return found.scatter > 0.0; }

std::string percent(double error, const Found& found) {
    return scatters(found) && found.scale > 0.0 ? fmt::format("{:.2g} %", 100.0 * error / found.scale)
                                                : fmt::format("{:.2g}", error);
}

std::string unit_text(const Found& found) { return found.unit == "1" ? "" : " (" + found.unit + ")"; }

void print_table(const Tradeoff& ways, const std::string& quantity) {
    const Found first = reference_of(ways, quantity);
    fmt::print("{}{}, against {}\n", quantity, unit_text(first), ways.reference);
    if (scatters(first))
        fmt::print("{:>14}  {:>10}  {:>5}  {:>10}  {:>10}  {}\n", "value", "bias", "runs", "error",
                   "CPU a run", "keys");
    else
        fmt::print("{:>10}  {:>10}  {}\n", "error", "CPU time", "keys");
    for (const Way& way : ways.ways) {
        const auto at = std::ranges::find(way.found, quantity, &Found::name);
        const std::string keys = fmt::format("{}", fmt::join(way.keys, " "));
        if (at == way.found.end())
            fmt::print("{:>10}  {}: {}\n", "-", keys, way.status);
        else if (scatters(first))
            fmt::print("{:>14.6g}  {:>10}  {:>5}  {:>10}  {:>10}  {}\n", at->value, percent(at->bias, *at),
                       way.runs, percent(at->error, *at), time_text(way.seconds), keys);
        else
            fmt::print("{:>10.2g}  {:>10}  {}\n", at->bias, time_text(way.seconds), keys);
    }
}

std::string describe(const Choice& choice) {
    const Found& f = *choice.found;
    if (!scatters(f))
        return fmt::format("{} {:.2g} ({}) in {}", f.name, choice.error(), f.unit,
                           time_text(choice.seconds()));
    return fmt::format("{} to {}: bias {} (measured {} +- {}), {} from the scatter of {} runs; {} of CPU",
                       f.name, percent(choice.error(), f), percent(choice.bias, f), percent(f.bias, f),
                       percent(f.bias_error, f), percent(choice.statistical, f), choice.runs,
                       time_text(choice.seconds()));
}

/// `table.key = value`, a line each.
std::string lines_of(const Choice& choice) {
    std::string text;
    for (const std::string& key : choice.way->keys) {
        const auto equals = key.find('=');
        text += key.substr(0, equals) + " = " + key.substr(equals + 1) + "\n";
    }
    if (scatters(*choice.found))
        text += fmt::format("granular.runs = {}\n", choice.runs);
    return text;
}

/// How near any way comes, where none is near enough.
std::string nearest(const Tradeoff& ways, const std::string& quantity) {
    const auto best = most_accurate(ways, quantity, HUGE_VAL);
    return best ? fmt::format("; the least biased one is off by {}", percent(best->bias, *best->found)) : "";
}

int answer(const Options& options, const Tradeoff& ways) {
    const std::string quantity = quantity_of(options, ways);
    const Found reference = reference_of(ways, quantity);
    const auto wanted = wanted_error(options);
    if (!wanted && !options.want_time) {
        print_table(ways, quantity);
        return 0;
    }
    if (wanted && wanted->relative && !(reference.scale > 0.0))
        throw InputError(
            fmt::format("--for \"{}\": {} is 0, so no error is a part of it; give the error itself",
                        options.want_error, quantity));
    const double error = !wanted ? 0.0 : wanted->relative ? wanted->error * reference.scale : wanted->error;
    const auto best =
        wanted ? cheapest(ways, quantity, error) : most_accurate(ways, quantity, *options.want_time);
    if (!best)
        throw RunError(
            wanted ? fmt::format("no way that was tried has a {} within {}{}", quantity, options.want_error,
                                 nearest(ways, quantity))
                   : fmt::format("no way that was tried takes {} or less", time_text(*options.want_time)));
    if (!options.quiet)
        tell(fmt::format("{}\n", describe(*best)));
    if (!options.quiet && wanted && best->found->bias_error > error)
        tell(fmt::format("its bias is known less well than what was asked for: a longer --limit with "
                         "--force knows more\n"));
    fmt::print("{}", lines_of(*best));
    return 0;
}

int describe_work(const scene::Scene& scene, const std::filesystem::path& results,
                  const app::RunContext& context) {
    const Tradeoff ways = plan_ways(scene, results, context);
    fmt::print("{} ways would be measured, results in {}; the reference is {}:\n", ways.ways.size(),
               ways_folder(results, ways.part).string(), ways.reference);
    for (const Way& way : ways.ways)
        fmt::print("  {}\n", fmt::join(way.keys, " "));
    return 0;
}

void tell_measured(const Options& options, const std::filesystem::path& folder, double limit) {
    if (!options.quiet)
        tell(fmt::format("measured already in {}, with --limit {:g}s; --force measures anew\n",
                         folder.string(), limit));
}

int tradeoff_of_ways(const Options& options, const scene::Scene& scene, app::Part part) {
    wanted_error(options); // refused before anything is measured
    const std::filesystem::path results = output_folder(options), folder = ways_folder(results, part);
    app::RunContext context = context_of(options);
    context.tradeoff = {.part = part, .limit = options.limit};
    if (options.dry_run)
        return describe_work(scene, results, context);
    const auto earlier = options.force ? std::nullopt : app::read_ways(folder);
    if (measure_ways(scene, results, context) == app::StageEnd::interrupted)
        return signal_exit_code(stop_signal());
    const Tradeoff ways = *app::read_ways(folder);
    if (earlier && earlier->finished && earlier->limit == ways.limit)
        tell_measured(options, folder, ways.limit);
    else
        make_figures(folder, false, true);
    return stop_signal() ? signal_exit_code(stop_signal()) : answer(options, ways);
}

// Rods and scans.

/// --error, or the first kind. Throws InputError.
std::string kind_of(const Options& options) {
    constexpr auto names = field_names<app::RodErrors>();
    if (options.error_kind.empty())
        return std::string(names.front());
    std::string word = options.error_kind;
    if (const std::string wrong = one_of({names.begin(), names.end()})(word); !wrong.empty())
        throw InputError("--error: " + wrong);
    return word;
}

/// Absent without --for. An error of rods has no value that it could be a part of.
std::optional<double> error_wanted(const Options& options) {
    const auto wanted = wanted_error(options);
    if (wanted && (wanted->relative || !wanted->quantity.empty()))
        throw InputError(fmt::format(
            "--for \"{}\": of rods a plain number, such as 1e-6; --error says of what", options.want_error));
    return wanted ? std::optional(wanted->error) : std::nullopt;
}

/// Of a way that has it.
double error_of(const Way& way, const std::string& kind) { return way.find(kind)->bias; }

std::string way_text(const app::Setting& s) {
    std::string text = fmt::format("{}, {}, {}", s.method, s.form, s.field);
    if (s.table_tolerance > 0.0)
        text += fmt::format(" {:g}", s.table_tolerance);
    if (s.precision != app::Setting{}.precision)
        text += ", " + s.precision;
    return text;
}

/// The settings that no other one beats.
void print_front(const Tradeoff& table, const std::string& kind) {
    const auto front = pareto_front(table, kind);
    if (front.empty())
        throw RunError(fmt::format(
            "no setting has a {}: the reference ends otherwise; --error names another kind", kind));
    fmt::print("{:>10}  {:>12}  {:>8}  {:>10}  {}\n", "error", "time", "rhs", "rtol", "method, form, field");
    for (const Way* way : front)
        fmt::print("{:>10.2g}  {:>12}  {:>8}  {:>10g}  {}\n", error_of(*way, kind), time_text(way->seconds),
                   way->rhs_evaluations, way->setting.tolerance, way_text(way->setting));
}

/// What to do where no setting is good enough.
std::string advice(const Tradeoff& table, const std::string& kind, bool by_error) {
    const auto front = pareto_front(table, kind);
    if (front.empty())
        return fmt::format("no setting has a {}; --error names another kind", kind);
    const Way& nearest = by_error ? *front.back() : *front.front();
    return fmt::format("the {} one has an error of {:.2g} and takes {}",
                       by_error ? "most accurate" : "fastest", error_of(nearest, kind),
                       time_text(nearest.seconds));
}

int answer(const Options& options, const scene::Scene& scene, const Tradeoff& table) {
    const std::string kind = kind_of(options);
    const std::optional<double> error = error_wanted(options);
    if (!error && !options.want_time) {
        print_front(table, kind);
        return 0;
    }
    const auto best = error ? cheapest(table, kind, *error) : most_accurate(table, kind, *options.want_time);
    if (!best)
        throw RunError(fmt::format("no setting that was tried {}: {}",
                                   error ? fmt::format("has an error of {:g} or less", *error)
                                         : fmt::format("takes {} or less", time_text(*options.want_time)),
                                   advice(table, kind, error.has_value())));
    if (!options.quiet)
        tell(fmt::format("{} {:.2g}; {} for {}, {} right-hand sides\n", kind, best->error(),
                         time_text(best->seconds()), table.unit, best->way->rhs_evaluations));
    fmt::print("{}", scene_keys(scene, best->way->setting));
    return 0;
}

constexpr app::Stage only[] = {app::Stage::tradeoff};

/// 0, or the exit code of a measurement that did not come to its end.
int measure(const Options& options, const scene::Scene& scene, const std::filesystem::path& folder) {
    app::RunContext context = context_of(options);
    context.tradeoff = {.kind = kind_of(options), .limit = options.limit};
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
    const Tradeoff table = app::read_tradeoff(folder);
    if (app::work_of(app::plan_run(scene, only, folder, {})) != table.work)
        throw InputError(folder.string() +
                         ": holds a measurement of other points of the scan; choose another folder "
                         "with -o, or --force to replace it");
    tell_measured(options, folder, table.limit);
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
