// rodwake design: experiments that would tell the rivals of a fit apart, before they are done.

#include "rodwake/app/fit_design.hpp"
#include "rodwake/core/error.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

namespace rodwake::cli {

namespace {

void print_designs(const app::WeighedDesigns& found) {
    std::vector<std::size_t> order(found.designs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::ranges::greater(),
                             [&](std::size_t i) { return found.designs[i].information; });
    fmt::print("{} told apart, of {:.3g} bits:\n{:>14}  {:>7}  {:>13}  {:>4}  {}\n",
               fmt::join(found.models, ", "), std::log2(static_cast<double>(found.models.size())), "bits",
               "wins", "log Bayes, least", "runs", "design");
    for (const std::size_t i : order) {
        const app::WeighedDesign& one = found.designs[i];
        fmt::print("{:>14}  {:>5.0f} %  {:>16.3g}  {:>4}  {}\n",
                   fmt::format("{:.2f} +- {:.2f}", one.information, one.error), 100.0 * one.right,
                   one.least_log_bayes(), one.runs, fmt::join(one.settings, " "));
    }
}

} // namespace

int verb_design(const Options& options) {
    const std::filesystem::path folder = output_folder(options), file = folder / "design.json";
    const scene::Scene scene = scene_of(options);
    if (exists(file) && !options.force && !options.dry_run)
        throw InputError(file.string() + ": is there; --force replaces it, or name another folder with -o");
    const app::RunContext context = context_of(options);
    const app::DesignRequest& request = options.design;
    if (options.dry_run) {
        app::DesignRequest few = request;
        few.sets = 1; // whatever is refused, is now
        const auto found = weigh_designs(scene, few, context);
        fmt::print("{} designs would be weighed, {} sets of tracks by each of {}, results in {}\n",
                   found.designs.size(), request.sets, fmt::join(found.models, ", "), folder.string());
        return 0;
    }
    const app::WeighedDesigns found = weigh_designs(scene, request, context);
    if (!found.finished)
        return signal_exit_code(stop_signal());
    write_designs(found, request, folder, options.command);
    make_figures(folder, false, true);
    if (!options.quiet)
        print_designs(found);
    return stop_signal() ? signal_exit_code(stop_signal()) : 0;
}

} // namespace rodwake::cli
