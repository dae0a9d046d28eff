#include "options.hpp"

#include "definition.hpp"
#include "usage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

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

std::string shell_command(int argc, const char* const* argv) {
    std::vector<std::string> words(argv, argv + argc);
    std::ranges::transform(words, words.begin(), quoted);
    return fmt::format("{}", fmt::join(words, " "));
}

bool is_set_option(const std::string& word) { return word == "-s" || word == "--set"; }

/// `-s key = value`, three words to a shell, as one.
std::vector<std::string> joined_settings(std::vector<std::string> words) {
    for (std::size_t i = 1; i < words.size(); ++i)
        if (is_set_option(words[i - 1]) && i + 1 < words.size() && words[i + 1].starts_with("=")) {
            const std::size_t end = words[i + 1] == "=" ? std::min(i + 3, words.size()) : i + 2;
            for (std::size_t k = i + 1; k < end; ++k)
                words[i] += words[k];
            words.erase(words.begin() + static_cast<long>(i) + 1, words.begin() + static_cast<long>(end));
        }
    return words;
}

/// `help run` as `run --help`; what is no verb is looked up.
std::vector<std::string> with_help_option(const CLI::App& app, const std::vector<std::string>& words) {
    if (words.empty() || (words.size() == 1 && words[0] == "help"))
        return {"--help"};
    if (words.size() == 2 && words[0] == "help" && find_verb(app, words[1]))
        return {words[1], "--help"};
    return words;
}

/// With --points the answer goes to standard output and no scene takes part: what else is given would be
/// ignored.
void check_field_options(const CLI::App& app, const Options& options) {
    if (options.target.empty() == options.points.empty())
        throw CLI::ValidationError("field", "give either a SCENE or --points FILE");
    const CLI::App& field = *app.get_subcommand("field");
    if (options.points.empty() && field.count("--backend") > 0)
        throw CLI::ValidationError("--backend", "is for --points; a scene says medium.field");
    if (field.count("--table-tolerance") > 0 && options.backend != "table")
        throw CLI::ValidationError("--table-tolerance", "is for --points with --backend table; a scene says "
                                                        "medium.table.tolerance");
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
    parsed.options.command = shell_command(argc, argv);
    CLI::App app("rodwake: motile rods in an elastic medium", "rodwake");
    define_command_line(app, parsed.options);
    std::vector<std::string> words = with_help_option(app, joined_settings({argv + 1, argv + argc}));
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
        tell(fmt::format("rodwake: {}\n", usage_text(app, error)));
    }
    return parsed;
}

} // namespace rodwake::cli
