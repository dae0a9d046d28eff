// The manual page rodwake(1), in the man macros of roff.

#include "definition.hpp"
#include "rodwake/core/build_info.hpp"

#include <fmt/format.h>

#include <sstream>

namespace rodwake::cli {

namespace {

/// Text that roff prints as it stands.
std::string plain(const std::string& text) {
    std::string out = text.starts_with(".") || text.starts_with("'") ? "\\&" : "";
    for (const char c : text)
        out += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
    return out;
}

std::string options_text(const CLI::App& app) {
    std::string text;
    for (const CLI::Option* option : app.get_options()) {
        // "-o, --output TEXT" of an option, "SCENE" of a positional one.
        std::string term = option->get_positional()
                               ? option->get_name(true)
                               : fmt::format("{}", fmt::join(option_names(*option), ", "));
        if (!option->get_positional() && takes_value(*option))
            term += " " + option->get_type_name();
        text += fmt::format(".TP\n.B {}\n{}\n", plain(term), plain(option->get_description()));
    }
    return text;
}

} // namespace

std::string man_page(const CLI::App& app) {
    std::string text =
        fmt::format(".TH RODWAKE 1 \"\" \"rodwake {}\"\n.SH NAME\nrodwake \\- motile rods in an elastic "
                    "medium\n.SH SYNOPSIS\n.B rodwake\n.I VERB\n[\\fIOPTIONS\\fR]\n",
                    build_info().version);
    text += ".SH OPTIONS\n" + options_text(app) + ".SH VERBS\n";
    for (const CLI::App* verb : app.get_subcommands({})) {
        // The examples of a verb are shown without the exit codes that follow them.
        std::istringstream lines(verb->get_footer());
        std::string examples;
        for (std::string line; std::getline(lines, line);)
            if (line.starts_with("  rodwake") || line.starts_with("  mpiexec"))
                examples += plain(line) + "\n";
        text += fmt::format(".SS {}\n{}.\n{}{}", verb->get_name(), plain(verb->get_description()),
                            options_text(*verb), ".PP\n.nf\n" + examples + ".fi\n");
    }
    text += fmt::format(".SH EXIT STATUS\n.nf\n{}.fi\n", plain(exit_codes_text()));
    return text + ".SH SEE ALSO\nEvery key of a scene: rodwake info \\-\\-scene\\-reference.\n";
}

} // namespace rodwake::cli
