// rodwake help NAME: of what is no verb, what it means in scenes and results.

#include "definition.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"
#include "verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace rodwake::cli {

int verb_help(const Options& options) {
    const std::string& name = options.target;
    if (const auto text = app::explain(name)) {
        fmt::print("{}", *text);
        return 0;
    }
    const std::vector<std::string> similar = app::similar_names(name);
    // The nearest verb is named where there is one.
    Options unused;
    CLI::App definition("", "rodwake");
    define_command_line(definition, unused);
    std::vector<std::string_view> verbs;
    for (const CLI::App* known : definition.get_subcommands({}))
        verbs.push_back(known->get_name());
    const std::string verb = did_you_mean(name, verbs);
    if (!verb.empty() && name.find('.') == std::string::npos)
        throw InputError(fmt::format("{}: no such command{}", name, verb));
    throw InputError(fmt::format(
        "{}: no command, table or key of a scene, result file, column or value has this name{}", name,
        similar.empty() ? "; rodwake help lists the commands, docs/scene.md all keys"
                        : fmt::format("; near it: {}", fmt::join(similar, ", "))));
}

} // namespace rodwake::cli
