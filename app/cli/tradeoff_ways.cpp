// rodwake tradeoff of a bed, a fit or a field map: measured once, answered from then on.

#include "tradeoff_ways.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/error.hpp"
#include "signals.hpp"
#include "terminal.hpp"
#include "values.hpp"
#include "verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>

namespace rodwake::cli {

namespace {

using app::Choice;
using app::Found;
using app::Way;
using app::Ways;

app::WaysRequest request_of(const Options& options, app::Part part) { return {part, options.limit}; }

/// Of what the answer is about.
std::string quantity_of(const Options& options, const Ways& ways) {
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

void print_table(const Ways& ways, const std::string& quantity) {
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
std::string nearest(const Ways& ways, const std::string& quantity) {
    const auto best = most_accurate(ways, quantity, HUGE_VAL);
    return best ? fmt::format("; the least biased one is off by {}", percent(best->bias, *best->found)) : "";
}

int answer(const Options& options, const Ways& ways) {
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

int describe_work(const Options& options, const scene::Scene& scene, app::Part part) {
    const auto results = output_folder(options);
    const Ways ways = plan_ways(scene, request_of(options, part), results, context_of(options));
    fmt::print("{} ways would be measured, results in {}; the reference is {}:\n", ways.ways.size(),
               ways_folder(results, part).string(), ways.reference);
    for (const Way& way : ways.ways)
        fmt::print("  {}\n", fmt::join(way.keys, " "));
    return 0;
}

} // namespace

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

int tradeoff_of_ways(const Options& options, const scene::Scene& scene, app::Part part) {
    wanted_error(options); // refused before anything is measured
    if (options.dry_run)
        return describe_work(options, scene, part);
    const std::filesystem::path results = output_folder(options), folder = ways_folder(results, part);
    const app::RunContext context = context_of(options);
    const auto earlier = options.force ? std::nullopt : app::read_ways(folder);
    if (measure_ways(scene, request_of(options, part), results, context) == app::StageEnd::interrupted)
        return signal_exit_code(stop_signal());
    const Ways ways = *app::read_ways(folder);
    if (earlier && earlier->finished && earlier->limit == ways.limit) {
        if (!options.quiet)
            tell(fmt::format("measured already in {}, with --limit {:g}s; --force measures anew\n",
                             folder.string(), ways.limit));
    } else {
        make_figures(folder, false, true);
    }
    return stop_signal() ? signal_exit_code(stop_signal()) : answer(options, ways);
}

} // namespace rodwake::cli
