// rodwake check: the resolved scene, what will be modelled and what not and why, and what it will cost.

#include "rodwake/app/describe.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/scene/read.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

namespace rodwake::cli {

int verb_check(const Options& options) {
    const scene::Scene scene = scene_of(options);
    const app::RunContext context = context_of(options);
    const app::Plan plan = app::plan_check(scene, output_folder(options), context);
    if (options.quiet)
        return 0;
    const std::vector<std::string> doubts = app::doubts(plan);
    const std::vector<app::PlanLine> lines = app::describe(plan);
    fmt::print("{}\n# modelled\n", scene::to_toml(plan.scene));
    for (const app::PlanLine& line : lines)
        if (line.modelled)
            fmt::print("  {}\n", line.text);
    fmt::print("\n# not modelled\n");
    for (const app::PlanLine& line : lines)
        if (!line.modelled)
            fmt::print("  {}\n", line.text);
    if (!doubts.empty())
        fmt::print("\n# is this what you mean?\n  {}\n", fmt::join(doubts, "\n  "));
    fmt::print("\n# expected cost\n{}\n{}: ok\n", app::expected_cost(plan, output_folder(options), context),
               printable(options.target));
    return 0;
}

} // namespace rodwake::cli
