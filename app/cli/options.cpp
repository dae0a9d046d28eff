#include "options.hpp"

#include "definition.hpp"
#include "rodwake/core/spelling.hpp"
#include "terminal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace rodwake::cli {

namespace {

/// A word as a shell takes it: in single quotes if it has anything a shell would touch.
std::string quoted(const std::string& word) {
    constexpr std::string_view plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos)
        return word;
    std::string out = "'";
    for (const char c : word)
        out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

/// With --points the answer goes to standard output and no scene takes part: what else is given would be
/// ignored.
void check_field_options(const CLI::App& app, const Options& options) {
    if (options.target.empty() == options.points.empty())
        throw CLI::ValidationError("field", "give either a SCENE or --points FILE");
    const CLI::App& field = *app.get_subcommand("field");
    if (options.points.empty() && field.count("--backend") > 0)
        throw CLI::ValidationError("--backend", "applies to --points only; in a scene set medium.field");
    if (field.count("--table-tolerance") > 0 && options.backend != "table")
        throw CLI::ValidationError(
            "--table-tolerance",
            "applies to --points with --backend table only; in a scene set medium.table.tolerance");
    if (!options.points.empty() && !options.output.empty())
        throw CLI::ValidationError(
            "--output", "field --points writes to standard output and makes no folder; use > FILE");
    for (const char* flag : {"--set", "--seed", "--threads", "--force", "--quiet", "--verbose", "--log-json"})
        if (!options.points.empty() && field.count(flag) > 0)
            throw CLI::ValidationError(flag, "field --points makes no use of it");
}

} // namespace

std::optional<scan::Part> part_of(const Options& options) {
    long index = 0, of = 0;
    char end = 0;
    if (options.part.empty())
        return std::nullopt;
    if (std::sscanf(options.part.c_str(), "%ld/%ld%c", &index, &of, &end) != 2 || index < 1 || of < index)
        throw CLI::ValidationError("--part", "expected i/n with 1 <= i <= n, found " + options.part);
    return scan::Part{index - 1, of};
}

std::filesystem::path output_folder(const Options& options) {
    const std::filesystem::path folder =
        options.output.empty()
            ? std::filesystem::path("results") / std::filesystem::path(options.target).stem()
            : std::filesystem::path(options.output);
    const auto part = part_of(options);
    return part ? folder / fmt::format("part-{}-of-{}", part->index + 1, part->of) : folder;
}

Parsed parse_command_line(int argc, const char* const* argv) {
    Parsed parsed;
    std::vector<std::string> line(argv, argv + argc);
    std::ranges::transform(line, line.begin(), quoted);
    parsed.options.command = fmt::format("{}", fmt::join(line, " "));
    CLI::App app("rodwake: motile rods in an elastic medium", "rodwake");
    define_command_line(app, parsed.options);
    // `-s key = value`, three words to a shell, is one setting.
    std::vector<std::string> words(argv + 1, argv + argc);
    for (std::size_t i = 1; i < words.size(); ++i)
        if ((words[i - 1] == "-s" || words[i - 1] == "--set") && i + 1 < words.size() &&
            words[i + 1].starts_with("=")) {
            const std::size_t end = words[i + 1] == "=" ? std::min(i + 3, words.size()) : i + 2;
            for (std::size_t k = i + 1; k < end; ++k)
                words[i] += words[k];
            words.erase(words.begin() + static_cast<long>(i) + 1, words.begin() + static_cast<long>(end));
        }

    // `help run` is `run --help`; what is no verb is looked up.
    if (words.empty() || (words.size() == 1 && words[0] == "help"))
        words = {"--help"};
    else if (words.size() == 2 && words[0] == "help" && find_verb(app, words[1]))
        words = {words[1], "--help"};
    try {
        refuse_misread_words(app, words);
        std::ranges::reverse(words); // as CLI11 takes them
        app.parse(words);
        if (parsed.options.verb == Verb::field)
            check_field_options(app, parsed.options);
        part_of(parsed.options);
    } catch (const CLI::Success& asked) {
        parsed.exit_now = true;
        app.exit(asked);
    } catch (const CLI::ParseError& error) {
        parsed.exit_now = true;
        parsed.exit_code = 2;
        print_message(fmt::format("rodwake: {}\n", usage_text(app, error)));
    }
    return parsed;
}

namespace {

using Words = std::vector<std::string>;

std::string suggestion(const std::string& word, const Words& known) {
    if (word.size() == 2 && word[0] == '-') // every letter is near every other
        return "";
    const std::vector<std::string_view> views(known.begin(), known.end());
    return did_you_mean(word, views);
}

bool has(const Words& words, const std::string& word) {
    return std::ranges::find(words, word) != words.end();
}

std::string command_of(const CLI::App& app) {
    return app.get_parent() ? "rodwake " + app.get_name() : "rodwake";
}

std::string unknown_option(const CLI::App& verb, const std::string& word) {
    const std::string name = word.substr(0, word.find('='));
    const Words known = option_names(verb);
    if (has(known, name)) // it was not taken as the verb's, so it stands before it
        return fmt::format("{}: comes after the command: {} {}", name, command_of(verb), name);
    for (const CLI::App* other : verb.get_subcommands({}))
        if (has(option_names(*other), name))
            return fmt::format("{}: comes after a command, for example rodwake {} {}", name,
                               other->get_name(), name);
    return fmt::format("{}: {} has no such option{}", name, command_of(verb), suggestion(name, known));
}

} // namespace

const CLI::App* find_verb(const CLI::App& app, const std::string& name) {
    const auto found = app.get_subcommands([&](const CLI::App* verb) { return verb->get_name() == name; });
    return found.empty() ? nullptr : found.front();
}

CLI::ValidationError unknown_verb(const CLI::App& app, const std::string& word) {
    Words verbs;
    for (const CLI::App* verb : app.get_subcommands({}))
        verbs.push_back(verb->get_name());
    const std::string near = suggestion(word, verbs);
    return CLI::ValidationError(
        word, word.ends_with(".toml") ? fmt::format("a command comes first, for example rodwake run {}", word)
              : near.empty()          ? fmt::format("no such command; there are {}", fmt::join(verbs, ", "))
                                      : "no such command" + near);
}

void refuse_misread_words(const CLI::App& app, std::span<const std::string> words) {
    if (words.empty())
        return;
    const CLI::App* verb = find_verb(app, words[0]);
    if (!verb && !words[0].starts_with("-"))
        throw unknown_verb(app, words[0]);
    const Words known = option_names(verb ? *verb : app);
    for (const std::string& word : words) {
        const std::string twice = "-" + word.substr(0, word.find('='));
        if (word.size() > 2 && word[0] == '-' && word[1] != '-' && has(known, twice))
            throw CLI::ValidationError(twice.substr(1), "a long option has two dashes: " + twice);
    }
}

std::string usage_text(const CLI::App& app, const CLI::ParseError& error) {
    // The message is about the verb of the line, or about the program itself.
    const auto verbs = app.get_subcommands();
    const CLI::App& verb = verbs.empty() ? app : *verbs.front();
    const Words left = app.remaining(true);
    const auto option = std::ranges::find_if(left, [](const auto& w) { return w.size() > 1 && w[0] == '-'; });
    if (option != left.end())
        return unknown_option(verb, *option);
    if (dynamic_cast<const CLI::ExtrasError*>(&error) && !left.empty()) {
        Words names; // SCENE, or nothing
        for (const CLI::Option* taken : verb.get_options())
            if (taken->get_positional())
                names.push_back(taken->get_name(true));
        return fmt::format("{}: not expected; {} takes {}", left.front(), command_of(verb),
                           names.empty() ? "no arguments" : fmt::format("one {}", fmt::join(names, " ")));
    }
    const std::string text = error.what();
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
        const std::string name = text.substr(0, text.find(':'));
        return fmt::format("{}: its value is missing{}; see {} --help", name,
                           name == "--set" ? ", table.key=value" : "", command_of(verb));
    }
    if (dynamic_cast<const CLI::RequiredError*>(&error))
        return fmt::format("{}; see {} --help", text, command_of(verb));
    if (const auto at = text.find(" excludes "); dynamic_cast<const CLI::ExcludesError*>(&error))
        return fmt::format("{} and {}: give one of them", text.substr(0, at), text.substr(at + 10));
    return text;
}

} // namespace rodwake::cli
